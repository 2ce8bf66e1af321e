#include "render/bounces/vertex_groups.h"

#include <algorithm>
#include <array>
#include <limits>

#include "common/base/hash.h"
#include "common/base/parallel.h"
#include "common/base/tuned.h"
#include "common/random/salts.h"
#include "common/random/sequence.h"

namespace shadowcache {

namespace {

/// Groups that a cluster is cut into, about.
SHADOWCACHE_TUNED(std::size_t, kGroupsOfCluster, 4);

/// Normals that differ by 1 are as far apart as places at this share of the set's extent.
SHADOWCACHE_TUNED(float, kNormalExtent, 0.0625f);

/// Clusters are split up to here by one thread, since all of a level are at hand.
constexpr std::size_t kFewParts = 64;

using Features = std::array<float, 6>;  ///< place and normal, to the same scale

struct Range {
    std::uint32_t begin, end;
    std::size_t size() const { return end - begin; }
};

/// Halves ranges of vertices at the median of the axis that they differ most along.
class ClusterTree {
public:
    ClusterTree(const PathLevel& level, std::vector<std::uint32_t>& order) : order_(order) {
        Vec3f low(std::numeric_limits<float>::max()), high(-low);
        for (const std::uint32_t i : order) {
            const Vec3f& p = level.vertices[i].target;
            for (int k = 0; k < 3; ++k) {
                low[k] = std::min(low[k], p[k]);
                high[k] = std::max(high[k], p[k]);
            }
        }
        const float scale =
            1 / std::max(kNormalExtent * (high - low).length(), std::numeric_limits<float>::min());
        features_.resize(level.vertices.size());
        for (const std::uint32_t i : order) {
            const PathVertex& v = level.vertices[i];
            const Vec3f place = (v.target - low) * scale;
            features_[i] = {place.x, place.y, place.z, v.normal.x, v.normal.y, v.normal.z};
        }
    }

    /// Splits `all` until no part has more than `most`; the parts in order.
    std::vector<Range> split(std::size_t most) const {
        std::vector<Range> parts{{0, static_cast<std::uint32_t>(order_.size())}};
        while (parts.size() < kFewParts) {
            std::vector<Range> halves;
            for (const Range& part : parts) {
                if (part.size() > most) {
                    const std::uint32_t middle = halve(part);
                    halves.push_back({part.begin, middle});
                    halves.push_back({middle, part.end});
                } else {
                    halves.push_back(part);
                }
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
    void splitBelow(const Range& part, std::size_t most, std::vector<Range>& out) const {
        if (part.size() <= most) {
            out.push_back(part);
            return;
        }
        const std::uint32_t middle = halve(part);
        splitBelow({part.begin, middle}, most, out);
        splitBelow({middle, part.end}, most, out);
    }

    std::uint32_t halve(const Range& part) const {
        Features low, high;
        low.fill(std::numeric_limits<float>::max());
        high.fill(std::numeric_limits<float>::lowest());
        for (std::uint32_t i = part.begin; i < part.end; ++i)
            for (std::size_t k = 0; k < low.size(); ++k) {
                low[k] = std::min(low[k], features_[order_[i]][k]);
                high[k] = std::max(high[k], features_[order_[i]][k]);
            }
        std::size_t axis = 0;
        for (std::size_t k = 1; k < low.size(); ++k)
            if (high[k] - low[k] > high[axis] - low[axis]) axis = k;
        const std::uint32_t middle = part.begin + static_cast<std::uint32_t>(part.size() / 2);
        const auto at = [&](std::uint32_t i) { return order_.begin() + i; };
        std::nth_element(
            at(part.begin), at(middle), at(part.end), [&](std::uint32_t a, std::uint32_t b) {
                return std::pair(features_[a][axis], a) < std::pair(features_[b][axis], b);
            });
        return middle;
    }

    std::vector<std::uint32_t>& order_;
    std::vector<Features> features_;
};

std::uint64_t shuffleKey(const PathVertex& vertex) {
    return hashWords(vertex.seed, RenderSalt::bounceShuffle);
}

}  // namespace

VertexGroups groupVertices(const PathLevel& level, std::size_t size) {
    VertexGroups groups;
    groups.begins.push_back(0);
    for (std::uint32_t i = 0; i < level.vertices.size(); ++i) {
        const PathVertex& v = level.vertices[i];
        if (v.isLit || v.sendsDiffuse) groups.order.push_back(i);
    }
    if (groups.order.empty()) return groups;
    const ClusterTree tree(level, groups.order);
    for (const Range& cluster : tree.split(size * kGroupsOfCluster)) {
        const std::size_t first = groups.members.size();
        for (std::uint32_t i = cluster.begin; i < cluster.end; ++i)
            if (level.vertices[groups.order[i]].sendsDiffuse)
                groups.members.push_back(groups.order[i]);
        const std::size_t count = groups.members.size() - first;
        if (count == 0) continue;
        std::sort(groups.members.begin() + static_cast<std::ptrdiff_t>(first), groups.members.end(),
                  [&](std::uint32_t a, std::uint32_t b) {
                      return std::pair(shuffleKey(level.vertices[a]), a) <
                             std::pair(shuffleKey(level.vertices[b]), b);
                  });
        const std::size_t parts = (count + size - 1) / size;
        for (std::size_t k = 1; k <= parts; ++k)
            groups.begins.push_back(static_cast<std::uint32_t>(first + count * k / parts));
    }
    return groups;
}

void stratifyNumbers(const VertexGroups& groups, PathLevel& level) {
    parallelFor(groups.count(), 256, [&](const Chunk& chunk) {
        std::vector<std::uint32_t> words;
        for (std::size_t g = chunk.begin; g < chunk.end; ++g) {
            const std::span<const std::uint32_t> members = groups.group(g);
            const std::uint64_t seed =
                hashWords(level.vertices[members.front()].seed, RenderSalt::bounceGroup);
            words.resize(members.size());
            for (int k = 0; k < 2; ++k) {
                owenSobol(0, k, seed, words);
                for (std::size_t i = 0; i < members.size(); ++i)
                    level.vertices[members[i]].numbers[k] = toUnitFloat(words[i]);
            }
        }
    });
}

}  // namespace shadowcache
