#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "render/bounces/direction_guide.h"
#include "render/bounces/vertex_groups.h"
#include "render/estimators/estimator.h"

namespace shadowcache {

/// Guides of a frame by cache item, each made when it is first asked for: the same whoever asks.
/// Thread-safe.
class ItemGuides {
public:
    /// @param context  with a RadiosityTree; outlives this object
    explicit ItemGuides(const EstimatorContext& context);

    const DirectionGuide& of(std::uint32_t item);

    /// Trial rays since the last call.
    std::uint64_t takeRays() { return rays_.exchange(0); }

private:
    struct Slot {
        std::once_flag made;
        DirectionGuide guide;
    };

    const EstimatorContext& context_;
    std::vector<Slot> slots_;
    std::atomic<std::uint64_t> rays_{0};
};

/// How the vertices of a level draw the directions of their diffuse rays.
class Guides {
public:
    /// All by the cosine.
    Guides() = default;
    // Vertices refer to guides of the object.
    Guides(Guides&&) = default;
    Guides& operator=(Guides&&) = default;

    /// Camera points: alike in each cluster.
    ///
    /// @param context  with a RadiosityTree
    /// @param rays     counts trial rays
    static Guides ofClusters(const EstimatorContext& context, std::span<const PathVertex> vertices,
                             const VertexGroups& groups, std::uint64_t& rays);

    /// Vertices of paths, by their items.
    ///
    /// @param guides  outlive this object
    static Guides ofItems(ItemGuides& guides, std::span<const PathVertex> vertices,
                          const VertexGroups& groups);

    const DirectionGuide& of(std::uint32_t vertex) const {
        return byVertex_.empty() || !byVertex_[vertex] ? cosine_ : *byVertex_[vertex];
    }

private:
    DirectionGuide cosine_;
    std::vector<DirectionGuide> clusters_;
    std::vector<const DirectionGuide*> byVertex_;  ///< null: by the cosine
};

}  // namespace shadowcache
