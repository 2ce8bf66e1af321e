#include "render/bounces/guides.h"

#include <algorithm>

#include "common/base/parallel.h"
#include "common/random/salts.h"
#include "common/random/sequence.h"
#include "render/bounces/guide_maker.h"
#include "render/bounces/item_looks.h"

namespace shadowcache {

namespace {

/// Members of a cluster whose trial rays stand for all.
constexpr std::size_t kTrialMembers = 32;

/// Clusters, and vertices, that a thread takes at a time.
constexpr std::size_t kClustersOfChunk = 8, kVerticesOfChunk = 1024;

}  // namespace

ItemGuides::ItemGuides(const EstimatorContext& context)
    : context_(context),
      slots_(context.radiosity ? context.radiosity->solve().items().size() : 0) {}

const DirectionGuide& ItemGuides::of(std::uint32_t item) {
    Slot& slot = slots_[item];
    std::call_once(slot.made, [&] {
        const ItemTable& items = context_.radiosity->solve().items();
        const Vec3f& normal = items.normal(item);
        const GuidePlace place{aboveItem(context_.scene, items, item), normal, normal};
        GuideMaker maker(context_);
        slot.guide = maker.make(std::span(&place, 1), hashWords(item, RenderSalt::itemTrial));
        rays_ += maker.rays();
    });
    return slot.guide;
}

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

Guides Guides::ofItems(ItemGuides& ofItems, std::span<const PathVertex> vertices,
                       const VertexGroups& groups) {
    Guides guides;
    guides.byVertex_.assign(vertices.size(), nullptr);
    parallelFor(groups.members.size(), kVerticesOfChunk, [&](const Chunk& chunk) {
        for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
            const std::uint32_t m = groups.members[i];
            if (vertices[m].item != kNoItem) guides.byVertex_[m] = &ofItems.of(vertices[m].item);
        }
    });
    return guides;
}

}  // namespace shadowcache
