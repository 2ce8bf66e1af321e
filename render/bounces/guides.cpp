#include "render/bounces/guides.h"

#include <algorithm>
#include <atomic>

#include "common/base/parallel.h"
#include "common/random/salts.h"
#include "common/random/sequence.h"
#include "render/bounces/guide_maker.h"

namespace shadowcache {

namespace {

/// Members of a cluster whose trial rays stand for all.
constexpr std::size_t kTrialMembers = 32;

/// Clusters that a thread takes at a time.
constexpr std::size_t kClustersOfChunk = 8;

}  // namespace

Guides Guides::ofClusters(const EstimatorContext& context, std::span<const PathVertex> vertices,
                          const VertexGroups& groups, std::uint64_t& rays) {
    Guides guides;
    const std::size_t count = groups.clusters.size() - 1;
    guides.clusters_.resize(count);
    guides.byVertex_.assign(vertices.size(), nullptr);
    std::atomic<std::uint64_t> sent{0};
    parallelFor(count, kClustersOfChunk, [&](const Chunk& chunk) {
        GuideMaker maker(context);
        std::vector<GuidePlace> places;
        for (std::size_t c = chunk.begin; c < chunk.end; ++c) {
            const auto members =
                std::span(groups.members)
                    .subspan(groups.clusters[c], groups.clusters[c + 1] - groups.clusters[c]);
            if (members.empty()) continue;
            places.clear();
            const std::size_t some = std::min(kTrialMembers, members.size());
            for (std::size_t i = 0; i < some; ++i) {
                const PathVertex& v = vertices[members[i * members.size() / some]];
                places.push_back({v.origin, v.normal, v.geometricNormal});
            }
            guides.clusters_[c] = maker.make(
                places, hashWords(vertices[members.front()].seed, RenderSalt::clusterTrial));
            for (const std::uint32_t m : members) guides.byVertex_[m] = &guides.clusters_[c];
        }
        sent += maker.rays();
    });
    rays += sent;
    return guides;
}

}  // namespace shadowcache
