// Clusters of vertices, and the groups of each, are as full as they may be.

#include "render/bounces/vertex_groups.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "common/random/sequence.h"

namespace shadowcache {
namespace {

constexpr GroupSizes kSizes{8, 4, false};
constexpr std::size_t kOfCluster = kSizes.vertices * kSizes.groups;

/// So many vertices all over a cube; each sends a diffuse ray.
VertexGroups groupsOf(std::size_t count) {
    std::vector<PathVertex> vertices(count);
    for (std::size_t i = 0; i < count; ++i) {
        vertices[i].seed = hashWords(i);
        for (int k = 0; k < 3; ++k)
            vertices[i].target[k] = toUnitFloat(
                static_cast<std::uint32_t>(hashWords(i, static_cast<std::uint64_t>(k) + 1)));
    }
    VertexChoice choice;
    choice.sendsDiffuse = true;
    return groupVertices(vertices, std::vector(count, choice), kSizes);
}

TEST(VertexGroups, AreAsFewAsTheyCanBe) {
    for (const std::size_t count : {1u, 31u, 32u, 33u, 1000u, 1100u, 2049u, 40'000u}) {
        const VertexGroups groups = groupsOf(count);
        const std::size_t clusters = groups.clusters.size() - 1;
        EXPECT_EQ(clusters, (count + kOfCluster - 1) / kOfCluster) << count;
        for (std::size_t c = 0; c < clusters; ++c) {
            const std::size_t size = groups.clusters[c + 1] - groups.clusters[c];
            EXPECT_LE(size, kOfCluster) << count;
            // The least that as many that are alike can have.
            EXPECT_GE(size, count / clusters) << count;
        }
        for (std::size_t g = 0; g < groups.count(); ++g)
            EXPECT_LE(groups.group(g).size(), kSizes.vertices) << count;
    }
}

TEST(VertexGroups, HoldEachVertexOnce) {
    const VertexGroups groups = groupsOf(1100);
    std::vector<std::uint32_t> all(1100);
    std::iota(all.begin(), all.end(), 0u);
    EXPECT_TRUE(std::ranges::is_permutation(groups.members, all));
    EXPECT_TRUE(std::ranges::is_permutation(groups.order, all));
}

TEST(VertexGroups, AreNear) {
    const std::size_t count = 40'000;
    const VertexGroups groups = groupsOf(count);
    // A cube of as many has this edge; groups are dealt at random in a cluster, so that it tells
    // the extent of clusters.
    const double edge = std::cbrt(static_cast<double>(kOfCluster) / static_cast<double>(count));
    const auto at = [](std::uint32_t i, int k) {
        return static_cast<double>(toUnitFloat(
            static_cast<std::uint32_t>(hashWords(i, static_cast<std::uint64_t>(k) + 1))));
    };
    double sum = 0;
    for (std::size_t c = 0; c + 1 < groups.clusters.size(); ++c)
        for (int k = 0; k < 3; ++k) {
            double low = 1, high = 0;
            for (std::size_t i = groups.clusters[c]; i < groups.clusters[c + 1]; ++i) {
                low = std::min(low, at(groups.members[i], k));
                high = std::max(high, at(groups.members[i], k));
            }
            sum += high - low;
        }
    const double mean = sum / 3 / static_cast<double>(groups.clusters.size() - 1);
    EXPECT_LT(mean, 1.2 * edge);
    EXPECT_GT(mean, 0.6 * edge);
}

}  // namespace
}  // namespace shadowcache
