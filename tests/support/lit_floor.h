#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "common/shot/camera.h"
#include "render/frame/options.h"
#include "tests/support/test_scenes.h"

namespace shadowcache::test {

// A floor under a slab, seen by a film from above, with caches that are right and wrong about it.

/// A constant sky with one bright texel that all of the film's floor sees and one that the slab
/// hides from all of it.
struct Light {
    static constexpr int kMapWidth = 64, kMapHeight = 32;
    std::array<int, 2> seen, hidden;
    Image map;

    Light();
};

/// Looks straight down at the floor, from below the slab: the film maps to the floor linearly.
struct View {
    static constexpr int kWidth = 18, kHeight = 12;

    static Camera camera();
    /// @param filmX, filmY  in [0, 1]
    static ShadingPoint place(double filmX, double filmY);
};

struct Effort {
    int cameraRays, samples;
};
/// Options of a film of the view's size.
RenderOptions effort(int cameraRays, int samples);

/// A change of what the bake found.
struct CacheKind {
    std::string name;
    std::function<void(BakeResult&)> change;
};
/// Correct, AllDark, AllVisible, Random, LampOccluded, LampVisible.
std::vector<CacheKind> cacheKinds();

/// Gives {n, d} to each base cell of each item, `counts(i)` to the i-th of all; finer counts are
/// removed.
void fillCounts(BakeResult& baked, const std::function<std::array<int, 2>(std::size_t)>& counts);

/// The floor under a slab, the light and a cache of one kind.
struct LitFloor {
    static constexpr int kStrips = 3;  ///< of the film, side by side, each with a truth of its own

    Light light;
    TriangleMesh mesh = slabMesh();
    Scene scene{mesh};
    Environment environment = environmentOf(light.map);
    TestCache cache;

    explicit LitFloor(const CacheKind& kind) : cache(baked(kind)) {}

    EstimatorContext context() const { return {scene, environment, &cache.cache()}; }

    /// Mean irradiance of a strip of the film, from `nodes` x `nodes` places in each pixel.
    Rgb truth(int strip, int nodes) const;
    /// Irradiance at the middle of a pixel.
    Rgb pixelTruth(int x, int y) const;

private:
    double at(double filmX, double filmY) const;  ///< in units of the sky
    BakeResult baked(const CacheKind& kind) const;
};

}  // namespace shadowcache::test
