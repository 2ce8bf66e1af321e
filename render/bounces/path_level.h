#pragma once

#include <vector>

#include "render/bounces/guides.h"
#include "render/bounces/path_vertex.h"
#include "render/bounces/vertex_groups.h"

namespace shadowcache {

/// A level of all paths; but for the groups, by number of its vertices.
struct PathLevel {
    PathVertices at;
    std::vector<VertexChoice> choices;
    VertexGroups groups;
    Guides guides;
    std::vector<VertexChildren> children;  ///< empty: paths end here
    std::vector<VertexLight> light;
    GroupedVertexLight groupedLight;

    std::size_t size() const { return at.vertices.size(); }
};

}  // namespace shadowcache
