#include "bake/core/merge.h"

#include <utility>
#include <vector>

#include "bake/core/cache_part.h"
#include "bake/core/merge_plan.h"
#include "common/base/progress.h"

namespace shadowcache {

namespace {

/// The sum of neighbouring inputs.
struct Run {
    CacheHeader header;
    CacheItems items;
    std::filesystem::path first;

    std::size_t bytes() const { return items.n.size() + items.blocks.size() * sizeof(CountBlock); }
};

void addRun(Run& sum, const Run& more) {
    const auto [header, overlap] =
        joinHeaders(sum.header, sum.first.string(), more.header, more.first);
    sum.items = mergeItems(sum.items, more.items, header.tiers(), overlap);
    sum.header = header;
}

}  // namespace

CacheItems mergeCaches(std::span<const std::filesystem::path> paths, CacheHeader& header) {
    planMerge(paths);
    Progress progress("merge", paths.size());
    // Sums wait until as much has come behind them: then each item is moved a few times only, and
    // what waits is smaller by half each. Inputs that share their items are added at once.
    std::vector<Run> runs;
    for (const auto& path : paths) {
        throwIfInterrupted();
        Run& read = runs.emplace_back();
        read.first = path;
        read.items = readCache(path, read.header);
        while (runs.size() > 1 && 2 * runs.back().bytes() >= runs[runs.size() - 2].bytes()) {
            addRun(runs[runs.size() - 2], runs.back());
            runs.pop_back();
        }
        progress.add(1);
    }
    while (runs.size() > 1) {
        addRun(runs[runs.size() - 2], runs.back());
        runs.pop_back();
    }
    header = std::move(runs.front().header);
    CacheItems items = std::move(runs.front().items);
    if (header.part) header.part = countPart(*header.part, items);
    return items;
}

}  // namespace shadowcache
