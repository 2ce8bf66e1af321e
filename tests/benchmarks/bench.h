#pragma once

#include <fmt/core.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bake/core/baker.h"
#include "common/base/json_file.h"
#include "common/cache/shadow_cache.h"
#include "common/light/environment.h"
#include "common/shot/camera.h"
#include "render/frame/compare.h"
#include "render/frame/integrator.h"
#include "render/table/estimator_table.h"

namespace shadowcache::bench {

/// What every benchmark may be told.
struct Settings {
    std::filesystem::path data;                ///< folder with scene/, env/ and reference/
    std::filesystem::path work = "out/bench";  ///< caches and references; the latter are used again
    std::vector<std::string> scenes{"kitchen", "atrium", "grove", "dragon"};
    std::vector<std::string> maps{"courtyard", "sunrise", "circus_arena"};
    std::vector<int> frames{1};
    int width = 240, height = 135;
    int samples = 64;
    int repeats = 3;
    bool full = false;  ///< all maps, two frames; scaling: up to 10^7 items
    std::vector<std::string> splits{"16x4", "64x1", "16x1", "4x1"};  ///< delivered: K x N
    int seeds = 0;     ///< delivered: renders to average over; 0: 2, with `full` 4
    bool crop = true;  ///< delivered: parts of large pictures, too
    BakeOptions bake;
    std::filesystem::path json;
};

/// A set with its cameras, ready to trace.
struct Set {
    std::string name;
    TriangleMesh mesh;
    CameraTrack cameras;
    std::unique_ptr<Scene> scene;
};

/// The files of a set.
struct SetFiles {
    std::filesystem::path mesh, cameras;
};
SetFiles setFiles(const Settings& settings, const std::string& name);
std::unique_ptr<Set> loadSet(const Settings& settings, const std::string& name);
std::filesystem::path mapFile(const Settings& settings, const std::string& name);
std::unique_ptr<Environment> loadMap(const Settings& settings, const std::string& name);

/// A cache baked with `options`, and what it took.
struct BakedCache {
    std::unique_ptr<ShadowCache> cache;
    double seconds = 0;
    double rays = 0;
    double fileBytes = 0;
};
BakedCache bakeCache(const Settings& settings, const Set& set, const BakeOptions& options,
                     const std::string& tag);

/// The cache that an earlier run left in the work folder, or a new one, which stays there.
BakedCache keptCache(const Settings& settings, const Set& set);

/// A frame of a set under a map, with what it takes to render it.
struct Frame {
    const EstimatorContext& context;
    const Set& set;
    std::string map;
    int number;

    /// Name in the JSON files.
    std::string key() const { return fmt::format("{}.{}.frame{}", set.name, map, number); }
};
/// Each scene, with its kept cache, under each map and from each frame of the settings.
void forEachFrame(const Settings& settings, const std::function<void(const Frame&)>& measure);

/// Under all maps, from the first frame and from the middle of the move.
Settings fullMatrix(Settings settings);

/// One rendered frame.
struct Rendered {
    Image image;
    RenderStats stats;
    double processorSeconds = 0;  ///< of all threads, divided by their number
};
Rendered renderWith(const EstimatorContext& context, const Set& set, const std::string& estimator,
                    int frame, const RenderOptions& options,
                    const EstimatorOptions& estimatorOptions = {});
/// The same with the camera rays that are asked for and no more, so that pictures of other samples
/// have the same.
Rendered renderWithSameRays(const EstimatorContext& context, const Set& set,
                            const std::string& estimator, int frame, const RenderOptions& options);
/// With one camera ray a pixel.
Rendered renderFrame(const EstimatorContext& context, const Set& set, const std::string& estimator,
                     int frame, int samples, std::uint64_t seed, const Settings& settings,
                     const EstimatorOptions& options = {});

/// Image good enough to judge others by, and the relative mean squared error it has itself.
struct Reference {
    Image image;
    double ownError = 0;
};
/// Mean of renders of `cache` with `samples` samples each, two where no number is given; an earlier
/// run's, if one left it in the work folder.
Reference makeReference(const EstimatorContext& context, const Set& set, int frame, int samples,
                        const Settings& settings, const std::string& tag);
Reference makeReference(const EstimatorContext& context, const Set& set, int frame,
                        const RenderOptions& options, const std::filesystem::path& work,
                        const std::string& tag, int renders = 2);

// The benchmarks, one file each.
void efficiency(const Settings& settings);
void delivered(const Settings& settings);
void gloss(const Settings& settings);
void breakEven(const Settings& settings);
void bakeSpeed(const Settings& settings);
void timeShares(const Settings& settings);
void memory(const Settings& settings);
void cycles(const Settings& settings);
void overCycles(const Settings& settings);
/// Pictures with four bounces, over Cycles and over brute force.
void bounces(const Settings& settings);
void scaling(const Settings& settings);
void trade(const Settings& settings);
void oracle(const Settings& settings);
void sequences(const Settings& settings);
void flicker(const Settings& settings);
void mapTurns(const Settings& settings);
void preview(const Settings& settings);

}  // namespace shadowcache::bench
