#pragma once

#include <optional>

#include "common/cache/shadow_cache.h"
#include "common/image/exr.h"
#include "common/image/image.h"
#include "render/frame/compare.h"
#include "render/frame/film.h"
#include "render/frame/integrator.h"
#include "render/library/job.h"
#include "render/shot/light_plan.h"

namespace shadowcache {

// What a job writes: the frames' files, and the statistics.

/// Refuses names that no output can have. @throws Error
void validateOutputs(const RenderJob& job);

/// Refuses what could not be written, before the long work. @throws Error
void requireWritableOutputs(const RenderJob& job);

/// Refuses to write over what the run reads. @throws Error
void refuseToOverwriteInputs(const RenderJob& job, const LightPlan& plan);

/// Every file that a frame makes, the EXR first; with --png its pictures.
std::vector<std::filesystem::path> frameFiles(const RenderJob& job, int frame);

/// The EXR of a frame.
std::filesystem::path frameFile(const RenderJob& job, int frame);

/// What messages call the frames' files: the file of a single frame, else the name with '####'.
std::filesystem::path outputName(const RenderJob& job);

/// Metadata of a frame's file: how it was made.
struct FrameProgress {
    double seconds = 0;
    int cameraRays = 0;    ///< that each pixel has so far
    bool complete = true;  ///< false: --resume renders it again
};

/// The EXR, and with --png its pictures. @throws Error
void writeFrame(const RenderJob& job, const Film& film, Metadata metadata, const ExrView& view,
                const FrameProgress& progress, int frame);

/// Seconds that all frames share.
struct Timing {
    double load = 0, build = 0;
};

/// The JSON of --stats. @throws Error
void writeStats(const RenderJob& job, const PictureSettings& settings, const TriangleMesh& mesh,
                const ShadowCache* cache, const Timing& timing, const RenderStats& stats,
                const std::optional<RelativeError>& error);

}  // namespace shadowcache
