#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/bounces/path_vertex.h"

namespace shadowcache {

/// The vertices of a level along a walk through the set, and those of them that share what their
/// diffuse rays meet.
struct VertexGroups {
    std::vector<std::uint32_t> order;    ///< all vertices that are lit or send rays, near by near
    std::vector<std::uint32_t> members;  ///< those that send diffuse rays, group by group
    std::vector<std::uint32_t> begins;   ///< groups + 1 offsets into members

    std::size_t count() const { return begins.size() - 1; }
    std::span<const std::uint32_t> group(std::size_t i) const {
        return std::span(members).subspan(begins[i], begins[i + 1] - begins[i]);
    }
};

/// Clusters the vertices of a level by place and normal, and cuts each cluster at random into
/// groups of at most `size`, so that those of a group are near each other, but not the very next.
/// Decided by the vertices alone, in the same way for any number of threads.
VertexGroups groupVertices(const PathLevel& level, std::size_t size);

/// Gives the members of each cluster's groups points of one (0, 2)-sequence as the numbers of their
/// diffuse rays.
void stratifyNumbers(const VertexGroups& groups, PathLevel& level);

}  // namespace shadowcache
