#include "render/bounces/vertex_groups.h"

#include <algorithm>
#include <array>
#include <compare>
#include <limits>

#include "common/base/hash.h"
#include "common/base/parallel.h"
#include "common/base/tuned.h"
#include "common/random/salts.h"
#include "common/random/sequence.h"

namespace shadowcache {

namespace {

/// Normals that differ by 1 are as far apart as places at this share of the set's extent.
SHADOWCACHE_TUNED(float, kNormalExtent, 0.0625f);

/// Up to so many parts each round halves all; then each part is one thread's.
constexpr std::size_t kFewParts = 64;

/// Clusters that a thread takes at a time.
constexpr std::size_t kClustersOfChunk = 64;

/// Place and normal of a vertex, to the same scale.
struct Placed {
    std::array<float, 6> at;
    std::uint32_t number;
};

struct Range {
    std::uint32_t begin, end;
    std::size_t size() const { return end - begin; }
};

/// Splits ranges of vertices across the axis that they differ most along.
class ClusterTree {
public:
    ClusterTree(std::span<const PathVertex> vertices, std::span<const VertexChoice> choices) {
        for (std::uint32_t i = 0; i < vertices.size(); ++i) {
            if (!choices[i].any()) continue;
            const Vec3f &p = vertices[i].target, &n = vertices[i].normal;
            placed_.push_back({{p.x, p.y, p.z, n.x, n.y, n.z}, i});
        }
        Vec3f low(std::numeric_limits<float>::max()), high(-low);
        for (const Placed& p : placed_)
            for (int k = 0; k < 3; ++k) {
                low[k] = std::min(low[k], p.at[static_cast<std::size_t>(k)]);
                high[k] = std::max(high[k], p.at[static_cast<std::size_t>(k)]);
            }
        const float scale =
            1 / std::max(kNormalExtent * (high - low).length(), std::numeric_limits<float>::min());
        for (Placed& p : placed_)
            for (std::size_t k = 0; k < 3; ++k) p.at[k] *= scale;
    }

    bool empty() const { return placed_.empty(); }
    /// The vertices of a part.
    std::span<const Placed> of(const Range& part) const {
        return std::span(placed_).subspan(part.begin, part.size());
    }

    /// Splits all until no part has more than `most`; the parts in order.
    std::vector<Range> split(std::size_t most) {
        std::vector<Range> parts{{0, static_cast<std::uint32_t>(placed_.size())}};
        while (parts.size() < kFewParts) {
            std::vector<std::uint32_t> middles(parts.size());
            parallelFor(parts.size(), 1, [&](const Chunk& chunk) {
                for (std::size_t i = chunk.begin; i < chunk.end; ++i)
                    middles[i] = split(parts[i], most);
            });
            std::vector<Range> halves;
            for (std::size_t i = 0; i < parts.size(); ++i) {
                halves.push_back({parts[i].begin, middles[i]});
                if (middles[i] < parts[i].end) halves.push_back({middles[i], parts[i].end});
            }
            if (halves.size() == parts.size()) return parts;
            parts = std::move(halves);
        }
        std::vector<std::vector<Range>> below(parts.size());
        parallelFor(parts.size(), 1, [&](const Chunk& chunk) {
            for (std::size_t i = chunk.begin; i < chunk.end; ++i)
                splitBelow(parts[i], most, below[i]);
        });
        std::vector<Range> all;
        for (const std::vector<Range>& some : below)
            all.insert(all.end(), some.begin(), some.end());
        return all;
    }

private:
    void splitBelow(const Range& part, std::size_t most, std::vector<Range>& out) {
        const std::uint32_t middle = split(part, most);
        if (middle == part.end) {
            out.push_back(part);
            return;
        }
        splitBelow({part.begin, middle}, most, out);
        splitBelow({middle, part.end}, most, out);
    }

    /// Splits a range that makes n clusters of at most `most` into one that makes n / 2 of them and
    /// one that makes the others, in proportion.
    ///
    /// @return where the second begins; the end, if the range is one cluster
    std::uint32_t split(const Range& part, std::size_t most) {
        if (part.size() <= most) return part.end;
        const auto some = std::span(placed_).subspan(part.begin, part.size());
        std::array<float, 6> low = some.front().at, high = low;
        for (const Placed& p : some)
            for (std::size_t k = 0; k < low.size(); ++k) {
                low[k] = std::min(low[k], p.at[k]);
                high[k] = std::max(high[k], p.at[k]);
            }
        std::size_t axis = 0;
        for (std::size_t k = 1; k < low.size(); ++k)
            if (high[k] - low[k] > high[axis] - low[axis]) axis = k;
        const std::size_t parts = (some.size() + most - 1) / most;
        const std::size_t first = some.size() * (parts / 2) / parts;
        std::nth_element(some.begin(), some.begin() + static_cast<std::ptrdiff_t>(first),
                         some.end(), [&](const Placed& a, const Placed& b) {
                             return std::pair(a.at[axis], a.number) <
                                    std::pair(b.at[axis], b.number);
                         });
        return part.begin + static_cast<std::uint32_t>(first);
    }

    std::vector<Placed> placed_;
};

/// Brings vertices of one pixel together, and shuffles pixels, and vertices in a pixel.
struct DealKey {
    std::uint64_t pixel, vertex;
    std::uint32_t number;
    auto operator<=>(const DealKey&) const = default;
};

DealKey dealKey(const PathVertex& v, std::uint32_t number, bool ofPixels) {
    return {ofPixels ? v.pixelSeed : 0, hashWords(v.seed, RenderSalt::bounceShuffle), number};
}

/// The members of a cluster, group by group, where each group ends, and the number of each member
/// in the cluster's sequence.
struct Deal {
    std::vector<std::uint32_t> members, ends, places;
};

/// Cuts a cluster into groups of at most `sizes.vertices`. What one pixel's camera rays met follow
/// each other in the sequence, and go to different groups.
Deal deal(std::span<const PathVertex> vertices, std::span<const VertexChoice> choices,
          std::span<const Placed> cluster, const GroupSizes& sizes) {
    std::vector<DealKey> keys;
    for (const Placed& p : cluster)
        if (choices[p.number].sendsDiffuse)
            keys.push_back(dealKey(vertices[p.number], p.number, sizes.ofPixels));
    std::ranges::sort(keys);
    const std::size_t count = keys.size(), parts = (count + sizes.vertices - 1) / sizes.vertices;
    Deal all;
    for (std::size_t part = 0; part < parts; ++part) {
        const std::size_t step = sizes.ofPixels ? parts : 1;
        const std::size_t begin = sizes.ofPixels ? part : count * part / parts;
        const std::size_t end = sizes.ofPixels ? count : count * (part + 1) / parts;
        for (std::size_t i = begin; i < end; i += step) {
            all.members.push_back(keys[i].number);
            all.places.push_back(static_cast<std::uint32_t>(i));
        }
        all.ends.push_back(static_cast<std::uint32_t>(all.members.size()));
    }
    return all;
}

}  // namespace

VertexGroups groupVertices(std::span<const PathVertex> vertices,
                           std::span<const VertexChoice> choices, const GroupSizes& sizes) {
    VertexGroups groups;
    groups.begins.push_back(0);
    groups.clusters.push_back(0);
    ClusterTree tree(vertices, choices);
    if (tree.empty()) return groups;
    const std::vector<Range> clusters = tree.split(sizes.vertices * sizes.groups);
    std::vector<Deal> deals(clusters.size());
    parallelFor(clusters.size(), kClustersOfChunk, [&](const Chunk& chunk) {
        for (std::size_t c = chunk.begin; c < chunk.end; ++c)
            deals[c] = deal(vertices, choices, tree.of(clusters[c]), sizes);
    });
    for (std::size_t c = 0; c < clusters.size(); ++c) {
        for (const Placed& p : tree.of(clusters[c])) groups.order.push_back(p.number);
        const auto first = static_cast<std::uint32_t>(groups.members.size());
        for (const std::uint32_t end : deals[c].ends) groups.begins.push_back(first + end);
        groups.members.insert(groups.members.end(), deals[c].members.begin(),
                              deals[c].members.end());
        groups.places.insert(groups.places.end(), deals[c].places.begin(), deals[c].places.end());
        groups.clusters.push_back(static_cast<std::uint32_t>(groups.members.size()));
    }
    return groups;
}

DirectionNumbers stratifiedNumbers(std::span<const PathVertex> vertices,
                                   const VertexGroups& groups) {
    DirectionNumbers numbers(vertices.size());
    parallelFor(groups.clusters.size() - 1, kClustersOfChunk, [&](const Chunk& chunk) {
        std::vector<std::uint32_t> words;
        for (std::size_t c = chunk.begin; c < chunk.end; ++c) {
            const std::size_t begin = groups.clusters[c], end = groups.clusters[c + 1];
            if (begin == end) continue;
            const std::uint64_t seed =
                hashWords(vertices[groups.members[begin]].seed, RenderSalt::bounceGroup);
            words.resize(end - begin);
            for (const std::size_t k : {0u, 1u}) {
                owenSobol(0, static_cast<int>(k), seed, words);
                for (std::size_t i = begin; i < end; ++i)
                    numbers[groups.members[i]][k] = toUnitFloat(words[groups.places[i]]);
            }
        }
    });
    return numbers;
}

}  // namespace shadowcache
