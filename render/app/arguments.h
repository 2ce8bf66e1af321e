#pragma once

#include <optional>
#include <string>
#include <vector>

#include "render/app/job.h"

namespace shadowcache {

/// A command line as it was typed: plain values go straight into the job, others are texts that
/// jobOf() reads.
struct Arguments {
    RenderJob job;
    std::string up = "y", frames, shotFrames, size = "960x540", sequence = "sobol",
                budget = "adaptive", normals = "shading", albedo = "0.5", surfaces = "glossy",
                material, memory, crop, filter = "blackman-harris", bounces;
    std::string eye, target, debug, convolution = "table", pixelMap = "200x100";
    std::vector<std::string> dynamic;
    bool samplesGiven = false, cameraRaysGiven = false;
    std::optional<int> spp;  ///< shadow rays a pixel, in place of camera rays and samples
    std::optional<double> targetError;  ///< relMSE of a frame
    std::optional<int> setFrame;  ///< of glTF files, in whose pose all of the set stands still
    bool allowExternal = false;   ///< files of glTF sets outside of their folders
    bool list = false;            ///< print what the set has, do not render
};

/// As --sequence has them, in the order of Sequence.
const std::vector<std::string>& sequenceNames();

/// The job, its texts read. @throws Error naming the option, the text and the form wanted
RenderJob jobOf(const Arguments& arguments);

}  // namespace shadowcache
