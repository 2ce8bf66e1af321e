#pragma once

#include <vector>

#include "common/cache/transport.h"
#include "common/predict/radiosity_tree.h"
#include "render/bounces/item_looks.h"
#include "render/library/set_light.h"

namespace shadowcache::test {

/// A cache with its items, its transport and what bounces under an environment.
struct Solved {
    ItemTable items;
    BounceSolve solve;
    RadiosityTree radiosity;

    Solved(const Scene& scene, const Environment& environment, const ShadowCache& cache,
           const PlainLook& plain, int bounces, const SetLight* light = nullptr)
        : items(cache),
          solve(cache, items, readTransport(cache, items).value(), environment,
                looksOf(scene, items, plain), bounces,
                light ? light->predictItems(items) : std::vector<Rgb>()),
          radiosity(solve, looksOf(scene, items, plain), bounces - 1,
                    environment.luminanceWeights(), scene.mesh().origin) {}
};

}  // namespace shadowcache::test
