#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "bake/summary.h"
#include "common/error.h"
#include "common/json_file.h"
#include "common/version.h"

namespace shadowcache {
namespace {

std::string fingerprintText(const CacheHeader& header) {
    char text[17];
    std::snprintf(text, sizeof text, "%016llx",
                  static_cast<unsigned long long>(header.fingerprint));
    return text;
}

void printJson(const CacheHeader& header, const CacheItems& items, const CacheSummary& summary,
               std::uint64_t fileBytes) {
    JsonFile out;
    out.set("format", static_cast<std::uint64_t>(kCacheFormat));
    out.set("version", header.version);
    out.set("fingerprint", fingerprintText(header));
    out.set("spacing", header.spacing);
    out.set("level", static_cast<std::uint64_t>(header.level));
    out.set("refinement", std::string(header.adaptive ? "adaptive" : "uniform"));
    out.set("rays", static_cast<std::uint64_t>(header.rays));
    out.set("seeds", header.seeds);
    out.set("up_axis", header.upAxis);
    out.set("unit", header.unit);
    out.set("bounds.low", std::vector{summary.low.x, summary.low.y, summary.low.z});
    out.set("bounds.high", std::vector{summary.high.x, summary.high.y, summary.high.z});
    out.set("items", std::uint64_t{items.size()});
    out.set("voxels", summary.voxels);
    out.set("blocks", std::uint64_t{items.blocks.size()});
    out.set("regions.base", summary.base.counted);
    out.set("regions.base_pure_share", summary.base.pureShare());
    out.set("regions.finer", summary.finer.counted);
    out.set("regions.finer_pure_share", summary.finer.pureShare());
    out.set("openness",
            std::vector<std::uint64_t>(summary.openness.begin(), summary.openness.end()));
    out.set("bytes.file", fileBytes);
    for (const auto& [name, bytes] : summary.bytes) out.set("bytes." + name, bytes);
    std::fputs(out.text().c_str(), stdout);
}

void printTally(const char* name, const RegionTally& tally) {
    std::printf("%-14s %llu, %.1f %% of them pure\n", name,
                static_cast<unsigned long long>(tally.counted), 100 * tally.pureShare());
}

void printText(const CacheHeader& header, const CacheItems& items, const CacheSummary& summary,
               std::uint64_t fileBytes) {
    std::printf("baked by       shadowcache-bake %s, format %d\n", header.version.c_str(),
                kCacheFormat);
    std::printf("set            fingerprint %s, up axis %s, %g metres a unit\n",
                fingerprintText(header).c_str(), header.upAxis.c_str(), header.unit);
    std::printf("bounds         %g, %g, %g to %g, %g, %g\n", summary.low.x, summary.low.y,
                summary.low.z, summary.high.x, summary.high.y, summary.high.z);
    std::printf("directions     level %d (%s), %d rays, seeds %s\n", header.level,
                header.adaptive ? "adaptive" : "uniform", header.rays, header.seeds.c_str());
    std::printf("items          %zu in %llu voxels of %g, %zu blocks\n", items.size(),
                static_cast<unsigned long long>(summary.voxels), header.spacing,
                items.blocks.size());
    printTally("base regions", summary.base);
    printTally("finer regions", summary.finer);
    std::printf("items by open share of their directions\n");
    for (std::size_t bin = 0; bin < CacheSummary::kBins; ++bin) {
        const double share = static_cast<double>(summary.openness[bin]) /
                             static_cast<double>(std::max<std::size_t>(1, items.size()));
        std::printf("  %3zu to %3zu %%  %5.1f %%  %s\n", bin * 10, bin * 10 + 10, 100 * share,
                    std::string(static_cast<std::size_t>(std::lround(share * 50)), '#').c_str());
    }
    std::printf("bytes          %llu in the file; uncompressed:\n",
                static_cast<unsigned long long>(fileBytes));
    for (const auto& [name, bytes] : summary.bytes)
        std::printf("  %-18s %llu\n", name.c_str(), static_cast<unsigned long long>(bytes));
}

}  // namespace
}  // namespace shadowcache

int main(int argc, char** argv) try {
    using namespace shadowcache;
    CLI::App app("Says what a shadow cache holds.", "shadowcache-info");
    std::filesystem::path path;
    bool json = false;
    app.set_version_flag("--version", std::string("shadowcache-info ") + kVersion);
    app.add_option("CACHE", path, "Cache, from shadowcache-bake")->required();
    app.add_flag("--json", json, "The same as JSON");
    app.footer(
        "Examples:\n"
        "  shadowcache-info room.vdb\n"
        "  shadowcache-info room.vdb --json > room.json");
    CLI11_PARSE(app, argc, argv);
    CacheHeader header;
    const CacheItems items = readCache(path, header);
    const CacheSummary summary = summarize(header, items);
    (json ? printJson : printText)(header, items, summary, std::filesystem::file_size(path));
    if (std::fflush(stdout) != 0) throw Error("standard output cannot be written");
    return 0;
} catch (const std::exception& e) {
    std::fprintf(stderr, "shadowcache-info: %s\n", e.what());
    return 1;
}
