#include "bake/core/merge_plan.h"

#include <algorithm>

#include "bake/core/cache_match.h"
#include "bake/core/cache_part.h"

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
    const std::string seed = "seed " + std::to_string(bake.seed);
    const auto require = [&](const char* what, const auto& found, const auto& wanted) {
        requireSame(path, (seed + ": " + what).c_str(), found, wanted, ("as in " + owner).c_str());
    };
    require("rays", other.rays, bake.rays);
    require("program version", more.version, header.version);
    require("number of shards", other.shards, bake.shards);
    const bool otherShot = header.part && more.part && header.part->shots != more.part->shots;
    if (otherShot && sameBakes(header, more)) {
        if (allWhole(header) && allWhole(more)) return;
        throwFileError(path, "is of another shot than " + owner +
                                 ", and shards of one of them are missing: merge the shards of "
                                 "each shot first");
    }
    if (header.part.has_value() != more.part.has_value() && sameBakes(header, more)) {
        const auto of = [](const CacheHeader& h) { return h.part ? "a shot" : "the whole set"; };
        throwFileError(path, seed + " is of " + of(more) + ", expected one of " + of(header) +
                                 " as in " + owner);
    }
    const std::vector<ShardRange> shared = sharedShards(bake, other);
    if (shared.empty()) return;
    if (bake.shards == 1) throwFileError(path, seed + " is in " + owner + ", too");
    throwFileError(path, seed + ": shard " + shardsText(shared) + " of " +
                             std::to_string(bake.shards) + " is in " + owner + ", too");
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

std::vector<CacheHeader> planMerge(std::span<const std::filesystem::path> paths) {
    std::vector<CacheHeader> headers;
    CacheHeader sum;
    for (const auto& path : paths) {
        const CacheHeader& header = headers.emplace_back(readHeader(path));
        if (headers.size() == 1) {
            sum = header;
            continue;
        }
        // Those before are one by now; whoever holds the same shard is named.
        for (std::size_t i = 0; i + 1 < headers.size(); ++i)
            if (headers[i].bakes == header.bakes)
                joinHeaders(headers[i], paths[i].string(), header, path);
        sum = joinHeaders(sum, headers.size() == 2 ? paths[0].string() : "those before it", header,
                          path)
                  .header;
    }
    return headers;
}

std::string missingText(const CacheHeader& header) {
    std::string text;
    for (const BakeRecord& bake : header.bakes)
        if (!bake.whole())
            text += (text.empty() ? "" : "; ") + ("seed " + std::to_string(bake.seed)) +
                    ": shards " + shardsText(missingShards(bake)) + " of " +
                    std::to_string(bake.shards);
    return text;
}

}  // namespace shadowcache
