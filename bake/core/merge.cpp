#include "bake/core/merge.h"

#include <utility>
#include <vector>

#include "bake/core/cache_part.h"
#include "bake/core/merge_order.h"
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

/// Adds up runs. Sums wait until as much has come behind them: then each item is moved a few times
/// only, and what waits is smaller by half each. Inputs that share their items are added at once.
class Runs {
public:
    void add(Run run) {
        runs_.push_back(std::move(run));
        while (runs_.size() > 1 && 2 * runs_.back().bytes() >= runs_[runs_.size() - 2].bytes())
            joinLast();
    }

    /// Of at least one; none are left.
    Run sum() {
        while (runs_.size() > 1) joinLast();
        Run all = std::move(runs_.front());
        runs_.clear();
        return all;
    }

private:
    std::vector<Run> runs_;

    void joinLast() {
        const Run more = std::move(runs_.back());
        runs_.pop_back();
        Run& sum = runs_.back();
        const auto [header, overlap] =
            joinHeaders(sum.header, sum.first.string(), more.header, more.first);
        sum.items = mergeItems(sum.items, more.items, header.tiers(), overlap);
        sum.header = header;
    }
};

}  // namespace

CacheItems mergeCaches(std::span<const std::filesystem::path> paths, CacheHeader& header) {
    const MergeOrder order = orderMerge(paths);
    Progress progress("merge", paths.size());
    Runs all, shots, shards;
    for (const auto& ofSeeds : order) {
        for (const auto& ofShot : ofSeeds) {
            for (const std::size_t k : ofShot) {
                throwIfInterrupted();
                Run read;
                read.first = paths[k];
                read.items = readCache(paths[k], read.header);
                shards.add(std::move(read));
                progress.add(1);
            }
            shots.add(shards.sum());
        }
        all.add(shots.sum());
    }
    Run sum = all.sum();
    header = std::move(sum.header);
    CacheItems items = std::move(sum.items);
    if (header.part) header.part = countPart(*header.part, items);
    return items;
}

}  // namespace shadowcache
