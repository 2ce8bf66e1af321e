#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/image/exr.h"
#include "render/app/resume.h"
#include "render/library/job.h"
#include "render/shot/light_plan.h"

namespace shadowcache {

// Metadata of a frame's EXR: its settings and inputs, by which --resume and --check know it again.

/// Files whose change makes a picture another one.
std::vector<std::filesystem::path> inputsOf(const RenderJob& job, const LightPlan::Light& light);

/// All metadata of a frame's file but the time it took.
///
/// @param fingerprint  of the cache's set; none without a cache
Metadata frameMetadata(const RenderJob& job, const PictureSettings& settings,
                       std::optional<std::uint64_t> fingerprint, const LightPlan::Light& light,
                       int frame, InputHashes& inputs);

}  // namespace shadowcache
