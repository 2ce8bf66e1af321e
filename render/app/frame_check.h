#pragma once

#include <optional>

#include "render/app/job_output.h"
#include "render/app/resume.h"

namespace shadowcache {

// Which frames of a job are there, without loading the set.

/// Compares all files of a frame with what the job would write.
///
/// @param metadata  of frameMetadata()
FrameState stateOfFrame(const RenderJob& job, const PictureSettings& settings,
                        const Metadata& metadata, int frame);

/// Whether every frame exists as the job would render it. @throws Error
bool allFramesDone(const RenderJob& job, const PictureSettings& settings, const LightPlan& plan,
                   InputHashes& inputs);

/// --check: prints how many frames are done.
///
/// @throws Error naming each frame that is missing, incomplete or of other settings
void checkFrames(const RenderJob& job, const PictureSettings& settings, const LightPlan& plan,
                 InputHashes& inputs);

}  // namespace shadowcache
