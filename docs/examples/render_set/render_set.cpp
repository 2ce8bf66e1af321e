// Bakes a floor with a roof over its half and renders it twice, all in memory: once with the sky as
// it is, once with half of its light. Prints the mean of each picture:
//   render_set
#include <cstdio>
#include <exception>
#include <memory>

#include "bake/library/bake_set.h"
#include "common/base/watch.h"
#include "common/cache/cache_items.h"
#include "common/light/environment.h"
#include "common/shot/loaded_set.h"
#include "render/library/lit_stage.h"

using namespace shadowcache;

namespace {

RawMesh floorAndRoof() {
    RawMesh raw;
    raw.vertices = {{-2, 0, -2}, {2, 0, -2}, {2, 0, 2}, {-2, 0, 2},
                    {-2, 1, -2}, {0, 1, -2}, {0, 1, 2}, {-2, 1, 2}};
    raw.faceVertices = {0, 3, 2, 1, 4, 7, 6, 5};
    raw.faceSizes = {4, 4};
    return raw;
}

double meanLuminance(const Film& film) {
    double sum = 0;
    for (const Pixel& pixel : film.pixels) sum += static_cast<double>(pixel.color.y);
    return sum / static_cast<double>(film.pixels.size());
}

}  // namespace

int main() try {
    const auto set = makeSet("floor", floorAndRoof(), {});

    // Who watches is told how far a call is, and may end it from another thread.
    Watch watch;
    watch.onProgress = [](const std::string& task, std::uint64_t done, std::uint64_t total) {
        if (done == total) std::printf("%s: done\n", task.c_str());
    };
    std::unique_ptr<const ShadowCache> cache;
    {
        const WatchScope scope(&watch);
        BakeOptions options;
        options.spacing = 0.25;
        const BakeResult baked = bakeSet(*set, options);
        cache = makeCache(baked.header, baked.items);
    }
    std::printf("%zu items\n", cache->itemCount());

    LitStage stage(set->scene, cache.get(), findEstimator("cache"), {});
    const Camera camera = lookAt({3, 2, 4}, {0, 0.3, 0}, {0, 1, 0}, 0.7);
    RenderOptions options;
    options.width = options.height = 16;
    for (const float radiance : {1.0f, 0.5f}) {
        const Environment sky({1, 1, {Rgb(radiance)}}, 0, Rgb(0.2126f, 0.7152f, 0.0722f));
        stage.setEnvironment(sky);
        RenderStats stats;
        const Film film = stage.plan(camera, 1, options, stats).film(stats);
        std::printf("sky %.1f: mean %.4f\n", static_cast<double>(radiance), meanLuminance(film));
    }
} catch (const std::exception& e) {
    std::fprintf(stderr, "render_set: %s\n", e.what());
    return 1;
}
