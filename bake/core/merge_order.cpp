#include "bake/core/merge_order.h"

#include <fmt/core.h>

#include <algorithm>

#include "bake/core/cache_match.h"
#include "bake/core/cache_part.h"
#include "bake/core/emitter_match.h"

namespace shadowcache {

namespace {

BakeRecord* find(std::vector<BakeRecord>& bakes, std::uint64_t seed) {
    const auto found = std::ranges::find(bakes, seed, &BakeRecord::seed);
    return found == bakes.end() ? nullptr : &*found;
}

/// Shards that both hold; nothing if there are none.
std::vector<ShardRange> sharedShards(const BakeRecord& a, const BakeRecord& b) {
    std::vector<ShardRange> shared;
    for (const ShardRange& x : a.held)
        for (const ShardRange& y : b.held)
            if (x.first <= y.last && y.first <= x.last)
                shared.push_back({std::max(x.first, y.first), std::min(x.last, y.last)});
    return shared;
}

std::vector<ShardRange> unite(std::vector<ShardRange> shards, const std::vector<ShardRange>& more) {
    shards.insert(shards.end(), more.begin(), more.end());
    std::ranges::sort(shards, {}, &ShardRange::first);
    std::vector<ShardRange> united;
    for (const ShardRange& range : shards)
        if (united.empty() || range.first > united.back().last + 1)
            united.push_back(range);
        else
            united.back().last = std::max(united.back().last, range.last);
    return united;
}

/// Whether the caches were made by the same bakes, of whatever shards and shots.
bool sameBakes(const CacheHeader& a, const CacheHeader& b) {
    return std::ranges::equal(a.bakes, b.bakes, [](const BakeRecord& x, const BakeRecord& y) {
        return x.seed == y.seed && x.rays == y.rays;
    });
}

bool allWhole(const CacheHeader& header) {
    return std::ranges::all_of(header.bakes, &BakeRecord::whole);
}

/// Refuses rays that both caches have counted, unless these are two shots.
void requireOthers(const CacheHeader& header, const std::string& owner, const BakeRecord& bake,
                   const CacheHeader& more, const BakeRecord& other,
                   const std::filesystem::path& path) {
    const std::string seed = fmt::format("seed {}", bake.seed);
    const auto require = [&](const char* what, const auto& found, const auto& wanted) {
        requireSame(path, (seed + ": " + what).c_str(), found, wanted, ("as in " + owner).c_str());
    };
    require("rays", other.rays, bake.rays);
    require("program version", more.version, header.version);
    const bool otherShot = header.part && more.part && header.part->shots != more.part->shots;
    if (otherShot && sameBakes(header, more)) {
        if (allWhole(header) && allWhole(more)) return;
        throwFileError(path, "is of another shot than " + owner +
                                 ", and shards of one of them are missing: merge all shards of "
                                 "each shot");
    }
    require("number of shards", other.shards, bake.shards);
    if (header.part.has_value() != more.part.has_value() && sameBakes(header, more)) {
        const auto of = [](const CacheHeader& h) { return h.part ? "a shot" : "the whole set"; };
        throwFileError(path, seed + " is of " + of(more) + ", expected one of " + of(header) +
                                 " as in " + owner);
    }
    const std::vector<ShardRange> shared = sharedShards(bake, other);
    if (shared.empty()) return;
    if (bake.shards == 1) throwFileError(path, seed + " is in " + owner + ", too");
    throwFileError(path, fmt::format("{}: shard {} of {} is in {}, too", seed, shardsText(shared),
                                     bake.shards, owner));
}

std::string shotsOf(const CacheHeader& header) {
    return header.part ? header.part->shots : std::string();
}

MergeOrder orderOf(std::span<const CacheHeader> headers) {
    MergeOrder order;
    for (std::size_t k = 0; k < headers.size(); ++k) {
        const auto ofSeeds = std::ranges::find_if(order, [&](const auto& shots) {
            return sameBakes(headers[shots.front().front()], headers[k]);
        });
        if (ofSeeds == order.end()) {
            order.push_back({{k}});
            continue;
        }
        const auto ofShot = std::ranges::find_if(*ofSeeds, [&](const auto& shards) {
            return shotsOf(headers[shards.front()]) == shotsOf(headers[k]);
        });
        if (ofShot == ofSeeds->end())
            ofSeeds->push_back({k});
        else
            ofShot->push_back(k);
    }
    return order;
}

}  // namespace

JoinedHeader joinHeaders(const CacheHeader& header, const std::string& owner,
                         const CacheHeader& more, const std::filesystem::path& path) {
    const auto require = [&](const char* what, const auto& found, const auto& wanted) {
        requireSame(path, what, found, wanted, ("as in " + owner).c_str());
    };
    require("fingerprint of the set", fingerprintText(more.fingerprint),
            fingerprintText(header.fingerprint));
    require("spacing", more.spacing, header.spacing);
    require("direction level", more.level, header.level);
    require("adaptive refinement", more.adaptive, header.adaptive);
    require("hits of an item", more.hits, header.hits);
    requireSameEmitters(path, more.emitters, {header.emitters, owner});
    // Two shots of the same bakes meet in the same items.
    JoinedHeader joined{header, sameBakes(header, more) ? Overlap::keep : Overlap::add};
    for (const BakeRecord& other : more.bakes) {
        BakeRecord* bake = find(joined.header.bakes, other.seed);
        if (!bake) {
            joined.header.bakes.push_back(other);
            continue;
        }
        requireOthers(header, owner, *bake, more, other, path);
        bake->held = unite(std::move(bake->held), other.held);
        // As the bake that was not divided records it.
        if (bake->whole()) *bake = {bake->seed, bake->rays, 1, {{0, 0}}};
    }
    if (header.part && more.part)
        joined.header.part = joinParts(*header.part, *more.part);
    else
        joined.header.part.reset();
    return joined;
}

namespace {

/// Headers of caches as those of one.
class JoinedHeaders {
public:
    void add(const CacheHeader& header, const std::filesystem::path& path) {
        if (count_++ == 0) {
            sum_ = header;
            first_ = path;
            return;
        }
        sum_ = joinHeaders(sum_, count_ == 2 ? first_.string() : "those before it", header, path)
                   .header;
    }
    void add(const JoinedHeaders& other) { add(other.sum_, other.first_); }

private:
    CacheHeader sum_;
    std::filesystem::path first_;
    std::size_t count_ = 0;
};

}  // namespace

MergeOrder orderMerge(std::span<const std::filesystem::path> paths) {
    std::vector<CacheHeader> headers;
    for (const auto& path : paths) headers.push_back(readHeader(path));
    const MergeOrder order = orderOf(headers);
    JoinedHeaders all;
    for (const auto& ofSeeds : order) {
        JoinedHeaders shots;
        for (const auto& ofShot : ofSeeds) {
            JoinedHeaders shards;
            for (const std::size_t k : ofShot) {
                // Those before are one by now; whoever holds the same shard is named.
                for (const std::size_t before : ofShot) {
                    if (before == k) break;
                    if (headers[before].bakes == headers[k].bakes)
                        joinHeaders(headers[before], paths[before].string(), headers[k], paths[k]);
                }
                shards.add(headers[k], paths[k]);
            }
            shots.add(shards);
        }
        all.add(shots);
    }
    return order;
}

std::string missingText(const CacheHeader& header) {
    std::string text;
    for (const BakeRecord& bake : header.bakes)
        if (!bake.whole())
            text += fmt::format("{}seed {}: shards {} of {}", text.empty() ? "" : "; ", bake.seed,
                                shardsText(missingShards(bake)), bake.shards);
    return text;
}

}  // namespace shadowcache
