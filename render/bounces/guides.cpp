#include "render/bounces/guides.h"

#include <algorithm>
#include <atomic>

#include "common/base/parallel.h"
#include "common/random/salts.h"
#include "common/random/sequence.h"
#include "render/bounces/guide_maker.h"

namespace shadowcache {

namespace {

/// Vertices of a guide whose trial rays stand for all.
constexpr std::size_t kTrialMembers = 32;

/// Guides that a thread makes at a time.
constexpr std::size_t kGuidesOfChunk = 8;

}  // namespace

Guides Guides::ofClusters(const EstimatorContext& context, std::span<const PathVertex> vertices,
                          const VertexGroups& groups, std::size_t clustersOfGuide,
                          std::uint64_t& rays) {
    Guides guides;
    const std::size_t clusters = groups.clusters.size() - 1;
    const std::size_t count = (clusters + clustersOfGuide - 1) / clustersOfGuide;
    guides.guides_.resize(count);
    guides.byVertex_.assign(vertices.size(), nullptr);
    std::atomic<std::uint64_t> sent{0};
    parallelFor(count, kGuidesOfChunk, [&](const Chunk& chunk) {
        GuideMaker maker(context);
        std::vector<GuidePlace> places;
        for (std::size_t c = chunk.begin; c < chunk.end; ++c) {
            const std::uint32_t first = groups.clusters[c * clustersOfGuide];
            const std::uint32_t end =
                groups.clusters[std::min(clusters, (c + 1) * clustersOfGuide)];
            const auto members = std::span(groups.members).subspan(first, end - first);
            if (members.empty()) continue;
            places.clear();
            const std::size_t some = std::min(kTrialMembers, members.size());
            for (std::size_t i = 0; i < some; ++i) {
                const PathVertex& v = vertices[members[i * members.size() / some]];
                places.push_back({v.origin, v.normal, v.geometricNormal});
            }
            guides.guides_[c] = maker.make(
                places, hashWords(vertices[members.front()].seed, RenderSalt::clusterTrial));
            for (const std::uint32_t m : members) guides.byVertex_[m] = &guides.guides_[c];
        }
        sent += maker.rays();
    });
    rays += sent;
    return guides;
}

}  // namespace shadowcache
