#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/mesh/mesh.h"
#include "render/frame/options.h"
#include "render/shot/moving_set.h"

namespace shadowcache {

/// One run of shadowcache-render, as its command line asks.
struct RenderJob {
    std::vector<std::filesystem::path> files;
    MeshOptions mesh;

    std::vector<DynamicFile> dynamic;

    std::string environment;  ///< as LightPlan reads it
    std::string environmentRotation = "0";

    std::filesystem::path cache;
    bool staleOk = false;
    std::uint64_t memory = 0;  ///< bytes for the cache; 0: all of it is read

    std::string estimator;  ///< empty: `cache` with a cache, `mis` without
    EstimatorOptions estimatorOptions;
    RenderOptions render;

    std::string camera;  ///< a file, or the name of one of the set's cameras
    double fps = 24;     ///< of glTF's cameras and moving nodes
    std::vector<int> frames{1};
    std::optional<Vec3d> eye, lookAt;
    double fovYDegrees = 45;

    std::filesystem::path output;
    bool resume = false;  ///< keep frames that are done
    std::vector<std::string> aovs;
    bool half = false;
    bool png = false;
    float exposure = 0;
    std::filesystem::path reference;
    std::filesystem::path stats;
    double targetError = 0;  ///< relMSE to reach; 0: as many samples as `render` says
    bool explain = false;    ///< say what to expect, write nothing
    std::optional<std::array<int, 2>> debugPixel;  ///< print this pixel's story, write nothing
    int threads = 0;
    std::vector<std::pair<std::string, std::string>>
        settings;  ///< every option as given or defaulted
};

/// Does it. @throws Error
void run(const RenderJob& job);

/// Prints the cameras, animations and sizes of the set's glTF files. @throws Error
void listSet(const RenderJob& job);

}  // namespace shadowcache
