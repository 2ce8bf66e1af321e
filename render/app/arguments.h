#pragma once

#include <optional>
#include <string>

#include "common/command/shot_arguments.h"
#include "render/app/job.h"

namespace shadowcache {

/// A command line as it was typed: plain values go straight into the job, others are texts that
/// jobOf() reads.
struct Arguments {
    RenderJob job;
    ShotArguments shot;
    std::string shotFrames, albedo = "0.5", material, memory, crop, bounces;
    std::string eye, target, debug;
    bool preview = false;
    std::optional<int> spp;                  ///< shadow rays a pixel
    std::optional<int> cameraRays, samples;  ///< in place of `spp`
    std::optional<double> targetError;       ///< relMSE of a frame
    bool list = false;                       ///< print what the set has, do not render
    bool serve = false;                      ///< answer requests, of which all else is told
};

/// The job, its texts read. @throws Error naming the option, the text and the form wanted
RenderJob jobOf(const Arguments& arguments);

}  // namespace shadowcache
