#pragma once

// Private to the cache's .cpp files: OpenVDB, and the types of its grids that they use.

#include <openvdb/openvdb.h>
#include <openvdb/points/PointDataGrid.h>

#include "common/math/vec.h"

// The library of OpenVDB has these types compiled: a file that instantiates one takes up to half a
// minute. Builds with assertions or sanitizers compile their own.
#if defined(NDEBUG) && defined(__OPTIMIZE__)
namespace openvdb {
namespace OPENVDB_VERSION_NAME {
extern template class tree::Tree<FloatTree::RootNodeType>;
extern template class tree::Tree<Int32Tree::RootNodeType>;
extern template class tree::Tree<Vec3STree::RootNodeType>;
extern template class tree::Tree<points::PointDataTree::RootNodeType>;
extern template class Grid<FloatTree>;
extern template class Grid<Vec3STree>;
extern template class Grid<points::PointDataTree>;
}  // namespace OPENVDB_VERSION_NAME
}  // namespace openvdb
#endif

namespace shadowcache {

inline openvdb::Coord toCoord(const Vec3i& v) {
    return {v.x, v.y, v.z};
}
inline Vec3i toVoxel(const openvdb::Coord& v) {
    return {v.x(), v.y(), v.z()};
}

}  // namespace shadowcache
