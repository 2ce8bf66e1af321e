#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/bounces/path_vertex.h"

namespace shadowcache {

/// The vertices of a level along a walk through the set, and those of them that share what their
/// diffuse rays meet.
struct VertexGroups {
    std::vector<std::uint32_t> order;     ///< all vertices that are lit or send rays, near by near
    std::vector<std::uint32_t> members;   ///< those that send diffuse rays, group by group
    std::vector<std::uint32_t> places;    ///< of each member in the sequence of its cluster
    std::vector<std::uint32_t> begins;    ///< groups + 1 offsets into members
    std::vector<std::uint32_t> clusters;  ///< clusters + 1 such offsets

    std::size_t count() const { return begins.size() - 1; }
    std::span<const std::uint32_t> group(std::size_t i) const {
        return std::span(members).subspan(begins[i], begins[i + 1] - begins[i]);
    }
};

/// How large groups are.
struct GroupSizes {
    std::size_t vertices;  ///< most of a group
    std::size_t groups;    ///< of a cluster, about
    bool ofPixels;         ///< what the camera rays of one pixel met is dealt to different groups
};

/// Clusters the vertices of a level by place and normal, and deals those of each cluster out to
/// groups: at random, but vertices of one pixel to different groups, since a pixel gains from each
/// other pixel in its groups, and a group costs by its vertices alone. Decided by the vertices
/// alone, in the same way for any number of threads.
VertexGroups groupVertices(std::span<const PathVertex> vertices,
                           std::span<const VertexChoice> choices, const GroupSizes& sizes);

/// Points of one (0, 2)-sequence for the members of each cluster's groups.
DirectionNumbers stratifiedNumbers(std::span<const PathVertex> vertices,
                                   const VertexGroups& groups);

}  // namespace shadowcache
