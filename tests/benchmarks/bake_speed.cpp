// Rays a second of the bake against bare loops of Embree calls on the same rays.

#include <cstdio>

#include "common/base/parallel.h"
#include "common/base/process.h"
#include "tests/benchmarks/bare_embree.h"
#include "tests/benchmarks/bench.h"

namespace shadowcache::bench {

namespace {

/// A bake, watched.
struct Watched {
    Spied spied;
    double seconds = 0;    ///< on the clock
    double processor = 0;  ///< of all threads
    double items = 0;
    double blocks = 0;
    double spacing = 0;
};

Watched watchBake(const Scene& scene, const BakeOptions& options) {
    Watched w;
    spy(Spying::record);
    const double start = secondsNow(), processorStart = processorSeconds();
    const BakeResult result = bake(scene, options);
    w.seconds = secondsNow() - start;
    w.processor = processorSeconds() - processorStart;
    w.spied = endSpying();
    w.items = static_cast<double>(result.items.size());
    w.blocks = static_cast<double>(result.items.blocks.size());
    w.spacing = result.header.spacing;
    return w;
}

}  // namespace

void bakeSpeed(const Settings& settings) {
    JsonFile json;
    const double million = 1e-6, threads = threadCount();
    std::printf(
        "Millions of rays a second of processor time and thread; %d threads\n"
        "%-8s %7s %8s %8s %7s %6s | %6s | %6s %6s %6s %7s | %s\n",
        threadCount(), "scene", "spacing", "items", "M rays", "s", "cores", "bake", "single",
        "packet", "stream", "ordered", "bake/best");
    for (const std::string& name : settings.scenes) {
        const auto set = loadSet(settings, name);
        const Watched w = watchBake(*set->scene, settings.bake);
        const BareRates bare = measureBareEmbree(lastScene(), w.spied.bursts);
        const double rays = static_cast<double>(w.spied.rays), rate = rays / w.processor;
        std::printf("%-8s %7g %8.0f %8.1f %7.1f %6.2f | %6.2f | %6.2f %6.2f %6.2f %7.2f | %.2f\n",
                    name.c_str(), w.spacing, w.items, rays * million, w.seconds,
                    w.processor / w.seconds, rate * million, bare.single * million,
                    bare.packet * million, bare.stream * million, bare.orderly * million,
                    rate / bare.best());
        std::fflush(stdout);
        json.set(name + ".spacing", w.spacing);
        json.set(name + ".items", w.items);
        json.set(name + ".blocks", w.blocks);
        json.set(name + ".rays", rays);
        json.set(name + ".seconds", w.seconds);
        json.set(name + ".processor_seconds", w.processor);
        json.set(name + ".threads", threads);
        json.set(name + ".rays_per_processor_second.bake", rate);
        json.set(name + ".rays_per_processor_second.single", bare.single);
        json.set(name + ".rays_per_processor_second.packet", bare.packet);
        json.set(name + ".rays_per_processor_second.stream_incoherent", bare.stream);
        json.set(name + ".rays_per_processor_second.stream_coherent", bare.orderly);
        json.set(name + ".bake_over_best", rate / bare.best());
    }
    if (!settings.json.empty()) json.write(settings.json);
}

}  // namespace shadowcache::bench
