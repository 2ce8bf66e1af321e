#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/import/mesh_options.h"
#include "common/mesh/mesh.h"
#include "common/shot/camera_source.h"
#include "common/shot/moving_set.h"
#include "render/frame/options.h"
#include "render/shot/light_plan.h"
#include "render/table/estimator_table.h"

namespace shadowcache {

/// One run of shadowcache-render, as its command line asks.
struct RenderJob {
    std::vector<std::filesystem::path> files;
    MeshOptions mesh{.shadingNormals = true, .gloss = true};

    std::vector<DynamicFile> dynamic;

    LightOptions light;

    std::filesystem::path cache;
    bool staleOk = false;
    std::uint64_t memory = 0;  ///< bytes for the cache; 0: all of it is read

    std::string estimator;  ///< empty: `cache` with a cache, `mis` without
    EstimatorOptions estimatorOptions;
    Sequence sequence = Sequence::sobol;
    RenderOptions render;

    CameraOptions camera;
    double fps = 24;  ///< of glTF's cameras and moving nodes
    std::vector<int> frames{1};
    bool framesGiven = false;     ///< by --frames
    std::vector<int> shotFrames;  ///< that a plan of lights is spread over; empty: `frames`

    std::filesystem::path output;
    bool progressive = false;  ///< write the EXR after each pass
    double timeLimit = 0;      ///< seconds for the passes of a frame; 0: none
    bool resume = false;       ///< keep frames that are done
    bool check = false;        ///< look whether all frames are done, write nothing
    std::vector<std::string> aovs;
    bool half = false;
    bool png = false;
    float exposure = 0;
    std::filesystem::path reference;
    std::filesystem::path stats;
    double targetError = 0;  ///< relMSE to reach; 0: as many samples as `render` states
    bool explain = false;    ///< print what to expect, write nothing
    std::optional<std::array<int, 2>> debugPixel;  ///< print this pixel's story, write nothing
    int threads = 0;
    std::vector<std::pair<std::string, std::string>>
        settings;  ///< every option as given or defaulted
};

/// The estimator asked for, or the standard one: `cache` with a cache, `mis` without.
///
/// @throws Error naming the estimators there are
inline const EstimatorEntry& estimatorOf(const RenderJob& job) {
    if (!job.estimator.empty()) return findEstimator(job.estimator);
    return findEstimator(job.cache.empty() ? "mis" : "cache");
}

}  // namespace shadowcache
