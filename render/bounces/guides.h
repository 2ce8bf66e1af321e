#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/bounces/direction_guide.h"
#include "render/bounces/vertex_groups.h"
#include "render/estimators/estimator.h"

namespace shadowcache {

/// How the vertices of a level draw the directions of their diffuse rays.
class Guides {
public:
    /// All by the cosine.
    Guides() = default;
    // Vertices refer to guides of the object.
    Guides(Guides&&) = default;
    Guides& operator=(Guides&&) = default;

    /// Alike in each run of so many clusters.
    ///
    /// @param context  with a RadiosityTree
    /// @param rays     counts trial rays
    static Guides ofClusters(const EstimatorContext& context, std::span<const PathVertex> vertices,
                             const VertexGroups& groups, std::size_t clustersOfGuide,
                             std::uint64_t& rays);

    const DirectionGuide& of(std::uint32_t vertex) const {
        return byVertex_.empty() || !byVertex_[vertex] ? cosine_ : *byVertex_[vertex];
    }

private:
    DirectionGuide cosine_;
    std::vector<DirectionGuide> guides_;
    std::vector<const DirectionGuide*> byVertex_;  ///< null: by the cosine
};

}  // namespace shadowcache
