// Error and time of the pictures that are delivered: antialiased, with few samples a camera ray.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "common/base/error.h"
#include "tests/benchmarks/bench.h"
#include "tests/benchmarks/deviation.h"

namespace shadowcache::bench {

namespace {

/// Camera rays of a pixel and samples of each.
struct Split {
    int cameraRays, samples;

    std::string name() const { return std::to_string(cameraRays) + "x" + std::to_string(samples); }
    int rays() const { return cameraRays * samples; }
    bool operator==(const Split&) const = default;
};

/// Of each half of a reference, which then has 64 x 64.
constexpr Split kReferenceSplit{32, 64};

/// The control: a reference so much brighter must be told from the true one.
constexpr double kControl = 1.02;

Split parseSplit(const std::string& text) {
    Split split{0, 0};
    char rest = 0;
    if (std::sscanf(text.c_str(), "%dx%d%c", &split.cameraRays, &split.samples, &rest) != 2 ||
        split.cameraRays < 1 || split.samples < 1)
        throw Error("--splits " + text + ": wanted KxN, as in 16x4");
    return split;
}

/// All splits of as many rays: a power of 4 less samples with each, or what is left.
std::vector<Split> splitsOf(int rays) {
    std::vector<Split> splits;
    for (int cameraRays = rays; cameraRays > 1; cameraRays = (cameraRays + 3) / 4)
        if (rays % cameraRays == 0) splits.push_back({cameraRays, rays / cameraRays});
    splits.push_back({1, rays});
    return splits;
}

/// What is looked at of a frame.
struct View {
    const char* name;
    RenderOptions options;
};

/// The whole at 320x180; of a large one, whose pixels are smaller than items, the middle.
constexpr const char* kWhole = "whole";
View wholeView() {
    View view{kWhole, {}};
    view.options.width = 320;
    view.options.height = 180;
    return view;
}
View cropView() {
    View view{"crop", {}};
    view.options.width = 1920;
    view.options.height = 1080;
    view.options.crop = FilmRectangle{800, 450, 320, 180};
    return view;
}
constexpr Split kCropSplit{16, 1};

struct Measured {
    RelativeError error;
    double seconds = 0, own = 0, reused = 0;
    Deviation fromReference, fromBrighter;
    double efficiency() const { return 1 / (error.mean * seconds); }
    double efficiencyOfP99() const { return 1 / (error.p99 * seconds); }
};

/// Efficiency over that of the best `mis`, by the mean error and by its 99th percentile.
struct Gain {
    double byMean, byP99;
};

/// The most of each, over several.
struct Best {
    double byMean = 0, byP99 = 0;

    void add(const Measured& m) {
        byMean = std::max(byMean, m.efficiency());
        byP99 = std::max(byP99, m.efficiencyOfP99());
    }
    Gain gainOf(const Measured& m) const {
        return {m.efficiency() / byMean, m.efficiencyOfP99() / byP99};
    }
};

struct Scene {
    const EstimatorContext& context;
    const Set& set;
    std::string map;
    int frame;
    const View& view;
    const Image& reference;
    int seeds;

    std::string key(const Split& split, const std::string& estimator) const {
        return set.name + "." + map + ".frame" + std::to_string(frame) + "." + view.name + "." +
               split.name() + "." + estimator;
    }
};

/// Errors averaged over seeds, the least time.
Measured measure(const Scene& scene, const Split& split, const std::string& estimator) {
    Measured m;
    RenderOptions options = scene.view.options;
    options.cameraRays = split.cameraRays;
    options.samples = split.samples;
    EstimatorOptions estimatorOptions;
    estimatorOptions.cache.adaptive = true;
    const double share = 1.0 / scene.seeds;
    for (int i = 0; i < scene.seeds; ++i) {
        options.seed = static_cast<std::uint64_t>(i) + 1;
        const Rendered r =
            renderWith(scene.context, scene.set, estimator, scene.frame, options, estimatorOptions);
        const RelativeError e = relativeError(r.image, scene.reference);
        m.error.mean += e.mean * share;
        m.error.p99 += e.p99 * share;
        m.error.max = std::max(m.error.max, e.max);
        m.seconds = i == 0 ? r.processorSeconds : std::min(m.seconds, r.processorSeconds);
        const double pixels = static_cast<double>(r.image.pixels.size()) / share;
        m.own += static_cast<double>(r.stats.shadowRays - r.stats.reusedRays) / pixels;
        m.reused += static_cast<double>(r.stats.reusedRays) / pixels;
        m.fromReference.add(r.image, scene.reference, 1);
        m.fromBrighter.add(r.image, scene.reference, kControl);
    }
    return m;
}

void report(const Scene& scene, const Split& split, const std::string& estimator, const Measured& m,
            const Gain& gain, JsonFile& json) {
    std::printf("%-9s %-14s %5d %-5s %6s %-6s %9.3g %9.3g %9.3g %8.3f %8.1f %8.1f %8.2f %8.2f\n",
                scene.set.name.c_str(), scene.map.c_str(), scene.frame, scene.view.name,
                split.name().c_str(), estimator.c_str(), m.error.mean, m.error.p99, m.error.max,
                m.seconds, m.own, m.reused, gain.byMean, gain.byP99);
    std::fflush(stdout);
    const std::string key = scene.key(split, estimator);
    json.set(key + ".relmse", m.error.mean);
    json.set(key + ".p99", m.error.p99);
    json.set(key + ".max", m.error.max);
    json.set(key + ".seconds", m.seconds);
    json.set(key + ".own_rays", m.own);
    json.set(key + ".reused_rays", m.reused);
    json.set(key + ".times_best_mis", gain.byMean);
    json.set(key + ".times_best_mis_by_p99", gain.byP99);
}

/// Of logarithms, under several names.
class GeometricMeans {
public:
    void add(const std::string& name, double value) {
        Entry& entry = entries_[name];
        entry.logSum += std::log(value);
        entry.least = entry.count == 0 ? value : std::min(entry.least, value);
        ++entry.count;
    }

    /// @param key  of the JSON file, above the names
    void print(const char* what, const std::string& key, JsonFile& json) const {
        for (const auto& [name, entry] : entries_) {
            const double mean = std::exp(entry.logSum / entry.count);
            std::printf("%s, %s: geometric mean %.2f, least %.2f of %d\n", what, name.c_str(), mean,
                        entry.least, entry.count);
            json.set("summary." + key + "." + name + ".geometric_mean", mean);
            json.set("summary." + key + "." + name + ".least", entry.least);
        }
    }

private:
    struct Entry {
        double logSum = 0, least = 0;
        int count = 0;
    };
    std::map<std::string, Entry> entries_;
};

struct Summary {
    GeometricMeans gain, gainByP99, seconds;
};

/// `mis` at every split of so many rays.
std::vector<std::pair<Split, Measured>> measureMis(const Scene& scene, int rays) {
    std::vector<std::pair<Split, Measured>> found;
    for (const Split& split : splitsOf(rays))
        found.emplace_back(split, measure(scene, split, "mis"));
    return found;
}

void compare(const Scene& scene, const std::vector<Split>& splits, JsonFile& json,
             Summary& summary) {
    std::map<int, std::vector<std::pair<Split, Measured>>> mis;
    for (const Split& split : splits) {
        auto& all = mis[split.rays()];
        const bool first = all.empty();
        if (first) all = measureMis(scene, split.rays());
        Best best;
        for (const auto& [other, m] : all) best.add(m);
        if (first)
            for (const auto& [other, m] : all) report(scene, other, "mis", m, best.gainOf(m), json);
        const Measured cache = measure(scene, split, "cache");
        const Gain gain = best.gainOf(cache);
        report(scene, split, "cache", cache, gain, json);
        const std::string row = std::string(scene.view.name) + " " + split.name();
        for (const std::string& group : {std::string("all"), scene.set.name}) {
            summary.gain.add(row + " " + group, gain.byMean);
            summary.gainByP99.add(row + " " + group, gain.byP99);
        }
        for (const auto& [other, m] : all)
            if (other == split) summary.seconds.add(row, cache.seconds / m.seconds);
    }
    const Measured& m = mis.begin()->second.front().second;
    std::printf(
        "%-9s %-14s %5d %-5s mis over the reference (made with `cache`): %+.2f %%, %+.1f "
        "standard errors; over one 2 %% brighter: %+.1f\n",
        scene.set.name.c_str(), scene.map.c_str(), scene.frame, scene.view.name,
        100 * m.fromReference.mean(), m.fromReference.significance(),
        m.fromBrighter.significance());
    json.set(scene.key({0, 0}, "mis_over_reference"), m.fromReference.mean());
    json.set(scene.key({0, 0}, "mis_over_reference_standard_errors"),
             m.fromReference.significance());
}

void compareView(const EstimatorContext& context, const Set& set, const std::string& map, int frame,
                 const View& view, const std::vector<Split>& splits, const Settings& settings,
                 JsonFile& json, Summary& summary) {
    RenderOptions options = view.options;
    options.cameraRays = kReferenceSplit.cameraRays;
    options.samples = kReferenceSplit.samples;
    const std::string tag =
        set.name + "." + map + ".frame" + std::to_string(frame) + ".antialiased." + view.name;
    const Reference reference = makeReference(context, set, frame, options, settings.work, tag);
    const int seeds = settings.seeds > 0 ? settings.seeds : settings.full ? 4 : 2;
    compare({context, set, map, frame, view, reference.image, seeds}, splits, json, summary);
    std::printf("%-9s %-14s %5d %-5s relMSE of the reference itself: %.2g\n", set.name.c_str(),
                map.c_str(), frame, view.name, reference.ownError);
}

}  // namespace

void delivered(const Settings& chosen) {
    const Settings settings = chosen.full ? fullMatrix(chosen) : chosen;
    std::vector<Split> splits;
    for (const std::string& text : settings.splits) splits.push_back(parseSplit(text));
    JsonFile json;
    Summary summary;
    std::printf("seconds: of the processor, over the threads\n");
    std::printf("%-9s %-14s %5s %-5s %6s %-6s %9s %9s %9s %8s %8s %8s %8s %8s\n", "scene", "map",
                "frame", "view", "split", "", "relMSE", "p99", "max", "seconds", "own", "reused",
                "x mis", "by p99");
    for (const std::string& sceneName : settings.scenes) {
        const auto set = loadSet(settings, sceneName);
        const BakedCache baked = keptCache(settings, *set);
        for (const std::string& mapName : settings.maps) {
            const auto environment = loadMap(settings, mapName);
            const EstimatorContext context{*set->scene, *environment, baked.cache.get(), {}};
            for (const int frame : settings.frames) {
                compareView(context, *set, mapName, frame, wholeView(), splits, settings, json,
                            summary);
                if (settings.crop)
                    compareView(context, *set, mapName, frame, cropView(), {kCropSplit}, settings,
                                json, summary);
            }
        }
    }
    summary.gain.print("efficiency over the best mis of equal rays", "gain", json);
    summary.gainByP99.print("the same by p99", "gain_by_p99", json);
    summary.seconds.print("seconds over those of mis", "seconds", json);
    if (!settings.json.empty()) json.write(settings.json);
}

}  // namespace shadowcache::bench
