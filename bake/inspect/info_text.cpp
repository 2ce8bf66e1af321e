#include "bake/inspect/info_text.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "common/base/json_file.h"
#include "common/cache/stored_bytes.h"

namespace shadowcache {

namespace {

std::string tallyLine(const char* name, const RegionTally& tally) {
    return fmt::format("{:<14} {}, {:.1f} % of them pure\n", name, tally.counted,
                       100 * tally.pureShare());
}

template <std::size_t N>
std::string histogram(const std::array<std::uint64_t, N>& counts,
                      const std::vector<std::string>& labels) {
    std::uint64_t sum = 0;
    for (const std::uint64_t count : counts) sum += count;
    std::string text;
    for (std::size_t i = 0; i < N; ++i) {
        const double share =
            static_cast<double>(counts[i]) / static_cast<double>(std::max<std::uint64_t>(1, sum));
        const std::string bar(static_cast<std::size_t>(std::lround(share * 50)), '#');
        text += fmt::format("  {:<12} {:5.1f} %{}{}\n", labels[i], 100 * share,
                            bar.empty() ? "" : "  ", bar);
    }
    return text;
}

template <std::size_t N>
std::vector<std::uint64_t> asVector(const std::array<std::uint64_t, N>& counts) {
    return {counts.begin(), counts.end()};
}

std::vector<std::string> tenths() {
    std::vector<std::string> labels;
    labels.reserve(10);
    for (int i = 0; i < 10; ++i) labels.push_back(fmt::format("{} to {} %", i * 10, i * 10 + 10));
    return labels;
}

}  // namespace

namespace {

/// What the cache holds of its set, if not all.
std::string partText(const CacheHeader& header) {
    std::string text;
    for (const BakeRecord& bake : header.bakes)
        if (!bake.whole())
            text += fmt::format("shards         {} of {} of seed {}; missing {}\n",
                                shardsText(bake.held), bake.shards, bake.seed,
                                shardsText(missingShards(bake)));
    if (header.part)
        text += fmt::format("part           {} of {} sides of voxels, for {}\n", header.part->sides,
                            header.part->sidesOfSet, header.part->shots);
    return text;
}

/// "1234 bytes of the file (5.6 %)"
std::string partOfFile(std::uint64_t bytes, const CacheFacts& facts) {
    const double share = static_cast<double>(bytes) / static_cast<double>(facts.fileBytes);
    return fmt::format("{} bytes of the file ({:.1f} %)", bytes, 100 * share);
}

/// What the cache keeps of what its rays met.
std::string hitsText(const CacheFacts& facts) {
    if (facts.header.hits == 0) return "hits           none: baked with --no-transport or before\n";
    return fmt::format("hits           {} an item, {}\n", facts.header.hits,
                       partOfFile(facts.stored.hits, facts));
}

/// How much the cache knows of what shines.
std::string emittersText(const CacheFacts& facts) {
    if (facts.header.emitters.empty())
        return "emitters       none counted: the set had none, or was baked with --no-lamps\n";
    return fmt::format("emitters       {} counted by {} rays, {}\n", facts.header.emitters.size(),
                       facts.summary.emitterRays, partOfFile(facts.stored.emitters, facts));
}

}  // namespace

CacheFacts readFacts(const std::filesystem::path& path) {
    CacheFacts facts;
    facts.items = readCache(path, facts.header);
    facts.summary = summarize(facts.header, facts.items);
    facts.fileBytes = std::filesystem::file_size(path);
    facts.stored = storedBytes(path);
    return facts;
}

std::vector<std::string> rayLabels() {
    std::vector<std::string> labels{"none", "1"};
    for (int low = 2; low < 256; low *= 2)
        labels.push_back(fmt::format("{} to {}", low, 2 * low - 1));
    return labels;
}

std::vector<std::string> shareLabels() {
    std::vector<std::string> labels = tenths();
    labels.insert(labels.begin(), "occluded");
    labels.emplace_back("visible");
    return labels;
}

std::string factsAsJson(const CacheFacts& facts) {
    const auto& [header, items, summary, fileBytes, stored] = facts;
    JsonFile out;
    out.set("format", static_cast<std::uint64_t>(header.format));
    out.set("version", header.version);
    out.set("fingerprint", fingerprintText(header.fingerprint));
    out.set("spacing", header.spacing);
    out.set("level", static_cast<std::uint64_t>(header.level));
    out.set("refinement", std::string(header.adaptive ? "adaptive" : "uniform"));
    out.set("rays", static_cast<std::uint64_t>(header.rays()));
    out.set("seeds", header.seeds());
    out.set("bakes", bakesText(header.bakes));
    if (header.part) {
        out.set("part.sides", header.part->sides);
        out.set("part.sides_of_set", header.part->sidesOfSet);
        out.set("part.shots", header.part->shots);
    }
    out.set("up_axis", header.upAxis);
    out.set("unit", header.unit);
    out.set("bounds.low", std::vector{summary.low.x, summary.low.y, summary.low.z});
    out.set("bounds.high", std::vector{summary.high.x, summary.high.y, summary.high.z});
    out.set("items", std::uint64_t{items.size()});
    out.set("voxels", summary.voxels);
    out.set("subpatches", summary.subpatches);
    out.set("blocks", std::uint64_t{items.blocks.size()});
    out.set("regions.base", summary.base.counted);
    out.set("regions.base_pure_share", summary.base.pureShare());
    out.set("regions.finer", summary.finer.counted);
    out.set("regions.finer_pure_share", summary.finer.pureShare());
    out.set("regions.by_rays", asVector(summary.rays));
    out.set("regions.by_visible_share", asVector(summary.shares));
    out.set("openness", asVector(summary.skyVisibility));
    out.set("hits", static_cast<std::uint64_t>(header.hits));
    out.set("emitters", std::uint64_t{header.emitters.size()});
    out.set("emitter_rays", summary.emitterRays);
    out.set("bytes.file", fileBytes);
    out.set("bytes.hits", stored.hits);
    out.set("bytes.emitters", stored.emitters);
    for (const auto& [name, bytes] : summary.bytes) out.set("bytes." + name, bytes);
    return out.text();
}

std::string factsAsText(const CacheFacts& facts) {
    const auto& [header, items, summary, fileBytes, stored] = facts;
    std::string text =
        fmt::format("baked by       shadowcache-bake {}, format {}\n", header.version,
                    header.format) +
        fmt::format("set            fingerprint {}, up axis {}, {:g} metres a unit\n",
                    fingerprintText(header.fingerprint), header.upAxis, header.unit) +
        fmt::format("bounds         {:g}, {:g}, {:g} to {:g}, {:g}, {:g}\n", summary.low.x,
                    summary.low.y, summary.low.z, summary.high.x, summary.high.y, summary.high.z) +
        fmt::format("directions     level {} ({}), {} rays, seeds {}\n", header.level,
                    header.adaptive ? "adaptive" : "uniform", header.rays(), header.seeds()) +
        partText(header) +
        fmt::format("items          {} ({} of them subpatches) in {} voxels of {:g}, {} blocks\n",
                    items.size(), summary.subpatches, summary.voxels, header.spacing,
                    items.blocks.size()) +
        hitsText(facts) + emittersText(facts) + tallyLine("base regions", summary.base) +
        tallyLine("finer regions", summary.finer);
    text +=
        "items by visible share of their directions\n" + histogram(summary.skyVisibility, tenths());
    text += "regions by number of rays\n" + histogram(summary.rays, rayLabels());
    text += "regions by visible share of their rays\n" + histogram(summary.shares, shareLabels());
    text += fmt::format("bytes          {} in the file; uncompressed:\n", fileBytes);
    for (const auto& [name, bytes] : summary.bytes)
        text += fmt::format("  {:<18} {}\n", name, bytes);
    return text;
}

std::string skyAsText(const SkyView& view) {
    std::string text = fmt::format("items          {}", view.weights().size());
    if (view.weights().empty())
        return text + ": no items here (off the surfaces, or no side faces so)\n";
    text += ", weights";
    for (const float weight : view.weights()) text += fmt::format(" {:.3f}", weight);
    const SkyView::Figures f = view.figures();
    return text +
           fmt::format("\nknown          {:.1f} % of the hemisphere, {:.1f} % of that pure\n",
                       100 * f.known, 100 * f.pure) +
           fmt::format("visible        {:.1f} % of it, {:.1f} % weighted by the cosine\n",
                       100 * f.visible, 100 * f.visibleCosine) +
           fmt::format("toward         {:.3f}, {:.3f}, {:.3f}: the middle of the visible part\n",
                       f.bentNormal.x, f.bentNormal.y, f.bentNormal.z);
}

std::string skyAsJson(const SkyView& view) {
    const SkyView::Figures f = view.figures();
    JsonFile out;
    out.set("items", std::uint64_t{view.weights().size()});
    out.set("weights", std::vector<double>(view.weights().begin(), view.weights().end()));
    out.set("known", f.known);
    out.set("pure", f.pure);
    out.set("visible", f.visible);
    out.set("visible_cosine", f.visibleCosine);
    out.set("open_direction", std::vector{f.bentNormal.x, f.bentNormal.y, f.bentNormal.z});
    return out.text();
}

}  // namespace shadowcache
