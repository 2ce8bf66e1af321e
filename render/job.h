#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/mesh.h"
#include "render/options.h"

namespace shadowcache {

/// One run of shadowcache-render, as its command line asks.
struct RenderJob {
    std::vector<std::filesystem::path> files;
    MeshOptions mesh;

    std::string environment;  ///< a file, or "R,G,B"
    double environmentRotation = 0;

    std::filesystem::path cache;
    bool staleOk = false;

    std::string estimator;  ///< empty: `cache` with a cache, `mis` without
    EstimatorOptions estimatorOptions;
    RenderOptions render;

    std::filesystem::path cameraFile;
    std::vector<int> frames{1};
    std::optional<Vec3d> eye, lookAt;
    double fovYDegrees = 45;

    std::filesystem::path output;
    std::vector<std::string> aovs;
    bool half = false;
    bool png = false;
    float exposure = 0;
    std::filesystem::path reference;
    std::filesystem::path stats;
    bool explain = false;                          ///< say what to expect, write nothing
    std::optional<std::array<int, 2>> debugPixel;  ///< print this pixel's story, write nothing
    int threads = 0;
    std::vector<std::pair<std::string, std::string>>
        settings;  ///< every option as given or defaulted
};

/// Does it. @throws Error
void run(const RenderJob& job);

/// "1-24x2" or "1,5,9-12" -> frame numbers. @throws Error
std::vector<int> parseFrames(const std::string& text);

/// Output file of a frame: a run of '#' (or %0Nd) becomes the number, padded with zeros.
///
/// @throws Error if several frames would share one file
std::filesystem::path framePath(const std::filesystem::path& pattern, int frame, bool several);

}  // namespace shadowcache
