#include "bake/inspect/report.h"

#include <fmt/core.h>

#include "bake/inspect/grid_export.h"
#include "bake/inspect/html_page.h"
#include "bake/inspect/section_view.h"

namespace shadowcache {

namespace {

constexpr int kPictureSide = 480;

std::string text(double value) {
    return fmt::format("{:g}", value);
}

std::string text(const Vec3d& v) {
    return fmt::format("{:g}, {:g}, {:g}", v.x, v.y, v.z);
}

std::string percent(double share) {
    return fmt::format("{:.1f} %", 100 * share);
}

std::string megabytes(std::uint64_t bytes) {
    return fmt::format("{:.2f} MB", static_cast<double>(bytes) * 1e-6);
}

void addSettings(HtmlPage& page, const CacheFacts& facts) {
    const auto& [header, items, summary, fileBytes, stored] = facts;
    page.heading("Settings");
    page.table({{"baked by",
                 fmt::format("shadowcache-bake {}, file format {}", header.version, header.format)},
                {"fingerprint of the set", fingerprintText(header.fingerprint)},
                {"files of the set",
                 "up axis " + header.upAxis + ", " + text(header.unit) + " metres a unit"},
                {"bounds", text(summary.low) + " to " + text(summary.high)},
                {"spacing", text(header.spacing) + " m"},
                {"directions", fmt::format("level {}{}", header.level,
                                           header.adaptive ? ", finer only where rays disagreed"
                                                           : ", all at the finest level")},
                {"rays a region", fmt::format("{} where rays disagreed", header.rays())},
                {"seeds", header.seeds()},
                {"items", fmt::format("{} in {} voxels", items.size(), summary.voxels)},
                {"finer blocks", std::to_string(items.blocks.size())},
                {"pure regions", percent(summary.base.pureShare()) + " of the coarse, " +
                                     percent(summary.finer.pureShare()) + " of the finer"},
                {"emitters", fmt::format("{} counted, {} of the file", header.emitters.size(),
                                         megabytes(stored.emitters))},
                {"file", megabytes(fileBytes)}});
}

void addSlices(HtmlPage& page, const CacheFacts& facts) {
    page.heading("Slices: sky visibility");
    page.paragraph(
        "The set cut open at a quarter, at half and at three quarters of its extent, and looked at "
        "from above, from +Z and from +X. Colours are the visible share of the sky over each "
        "voxel's "
        "side that sees most of the upper sky; what lies deeper behind the cut is paler.");
    page.colorScale("occluded", "visible");
    const VoxelRuns runs = findVoxels(facts.items);
    const VolumeGrid skyVisibility =
        makeVolumeGrid(parseGridRequest("openness"), 0, facts.header, facts.items, runs, {});
    const char* names[] = {"from +X", "from above", "from +Z"};
    std::vector<std::pair<std::string, Image>> pictures;
    for (const int axis : {1, 2, 0})
        for (const double share : {0.25, 0.5, 0.75}) {
            const double place = facts.summary.low[axis] +
                                 share * (facts.summary.high[axis] - facts.summary.low[axis]);
            pictures.emplace_back(
                std::string(names[axis]) + ", cut at " + "XYZ"[axis] + " = " + text(place),
                sectionView(runs.voxels, skyVisibility.values, axis, share, kPictureSide));
        }
    page.pictures(pictures);
}

template <std::size_t N>
std::vector<std::uint64_t> countsOf(const std::array<std::uint64_t, N>& counts) {
    return {counts.begin(), counts.end()};
}

void addHistograms(HtmlPage& page, const CacheSummary& summary) {
    page.heading("Histograms");
    std::vector<std::string> shares = shareLabels();
    page.bars("Items by the visible share of their sky", {shares.begin() + 1, shares.end() - 1},
              countsOf(summary.skyVisibility));
    page.bars(
        "Regions by the visible share of their rays; \"occluded\" and \"visible\" are pure: all "
        "rays "
        "agreed",
        shares, countsOf(summary.shares));
    page.bars(
        "Regions by the number of their rays; those with none lie below the surface's "
        "horizon",
        rayLabels(), countsOf(summary.rays));
}

void addBytes(HtmlPage& page, const CacheSummary& summary) {
    page.heading("Bytes by attribute, before compression");
    std::vector<std::pair<std::string, std::string>> rows;
    for (const auto& [name, bytes] : summary.bytes) rows.emplace_back(name, megabytes(bytes));
    page.table(rows);
}

}  // namespace

std::string reportPage(const std::string& name, const CacheFacts& facts) {
    HtmlPage page("Shadow cache " + name);
    page.paragraph(
        "For every place near the surfaces of a static set, this cache stores which directions "
        "reach the sky. It depends on no light and no camera: one bake serves every shot of the "
        "set "
        "under any environment map.");
    addSettings(page, facts);
    addSlices(page, facts);
    addHistograms(page, facts.summary);
    addBytes(page, facts.summary);
    return page.text();
}

}  // namespace shadowcache
