// Error and time of the pictures that are delivered: antialiased, with few samples a camera ray.

#include <algorithm>
#include <cstdio>
#include <map>

#include "tests/benchmarks/antialiased.h"
#include "tests/benchmarks/geometric_means.h"

namespace shadowcache::bench {

namespace {

/// The middle of a large picture, whose pixels are smaller than items.
View cropView() {
    View view{"crop", {}};
    view.options.width = 1920;
    view.options.height = 1080;
    view.options.crop = FilmRectangle{800, 450, 320, 180};
    return view;
}
constexpr Split kCropSplit{16, 1};

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

void report(const Picture& picture, const Split& split, const std::string& estimator,
            const Measured& m, const Gain& gain, JsonFile& json) {
    std::printf("%-9s %-14s %5d %-5s %6s %-6s %9.3g %9.3g %9.3g %8.3f %8.1f %8.1f %8.2f %8.2f\n",
                picture.frame.set.name.c_str(), picture.frame.map.c_str(), picture.frame.number,
                picture.view.name, split.name().c_str(), estimator.c_str(), m.error.mean,
                m.error.p99, m.error.max, m.seconds, m.own, m.reused, gain.byMean, gain.byP99);
    std::fflush(stdout);
    const std::string key = picture.key(split, estimator);
    json.set(key + ".relmse", m.error.mean);
    json.set(key + ".p99", m.error.p99);
    json.set(key + ".max", m.error.max);
    json.set(key + ".seconds", m.seconds);
    json.set(key + ".own_rays", m.own);
    json.set(key + ".reused_rays", m.reused);
    json.set(key + ".times_best_mis", gain.byMean);
    json.set(key + ".times_best_mis_by_p99", gain.byP99);
}

struct Summary {
    GeometricMeans gain, gainByP99, seconds;
};

void compare(const Picture& picture, const std::vector<Split>& splits, JsonFile& json,
             Summary& summary) {
    std::map<int, std::vector<std::pair<Split, Measured>>> mis;
    for (const Split& split : splits) {
        auto& all = mis[split.rays()];
        const bool first = all.empty();
        if (first) all = measureMis(picture, split.rays());
        Best best;
        for (const auto& [other, m] : all) best.add(m);
        if (first)
            for (const auto& [other, m] : all)
                report(picture, other, "mis", m, best.gainOf(m), json);
        const Measured cache = measure(picture, split, "cache");
        const Gain gain = best.gainOf(cache);
        report(picture, split, "cache", cache, gain, json);
        const std::string row = std::string(picture.view.name) + " " + split.name();
        for (const std::string& group : {std::string("all"), picture.frame.set.name}) {
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
        picture.frame.set.name.c_str(), picture.frame.map.c_str(), picture.frame.number,
        picture.view.name, 100 * m.fromReference.mean(), m.fromReference.significance(),
        m.fromBrighter.significance());
    json.set(picture.key({0, 0}, "mis_over_reference"), m.fromReference.mean());
    json.set(picture.key({0, 0}, "mis_over_reference_standard_errors"),
             m.fromReference.significance());
}

void compareView(const Frame& frame, const View& view, const std::vector<Split>& splits,
                 const Settings& settings, JsonFile& json, Summary& summary) {
    const Reference reference = antialiasedReference(frame, view, settings.work);
    const int seeds = settings.seeds > 0 ? settings.seeds : settings.full ? 4 : 2;
    compare({frame, view, reference.image, seeds}, splits, json, summary);
    std::printf("%-9s %-14s %5d %-5s relMSE of the reference itself: %.2g\n",
                frame.set.name.c_str(), frame.map.c_str(), frame.number, view.name,
                reference.ownError);
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
    forEachFrame(settings, [&](const Frame& frame) {
        compareView(frame, wholeView(), splits, settings, json, summary);
        if (settings.crop) compareView(frame, cropView(), {kCropSplit}, settings, json, summary);
    });
    summary.gain.print("efficiency over the best mis of equal rays", "gain", json);
    summary.gainByP99.print("the same by p99", "gain_by_p99", json);
    summary.seconds.print("seconds over those of mis", "seconds", json);
    if (!settings.json.empty()) json.write(settings.json);
}

}  // namespace shadowcache::bench
