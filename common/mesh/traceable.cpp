#include "common/mesh/traceable.h"

#include <fmt/core.h>

#include <algorithm>
#include <map>

#include "common/base/error.h"
#include "common/math/limits.h"
#include "common/mesh/placed_mesh.h"

namespace shadowcache {

namespace {

/// Box of an instance's triangles in their own space.
Box3d localBounds(const TriangleMesh& mesh, const MeshInstance& instance) {
    MeshInstance unmoved = instance;
    unmoved.toWorld = {};
    return instanceBounds(mesh, unmoved);
}

/// Whether all of the box's corners are in reach once they are mapped. A sum of NaN and numbers is
/// NaN, which is not.
bool staysInReach(const Affine& map, const Box3d& box) {
    for (int k = 0; k < 8; ++k)
        if (!isInReach(map.point(Vec3d((k & 1 ? box.max : box.min).x, (k & 2 ? box.max : box.min).y,
                                       (k & 4 ? box.max : box.min).z))))
            return false;
    return true;
}

/// Largest factor by which the inverse lengthens an axis.
double inverseScale(const Affine& map) {
    const auto& [a, b, c] = map.axis;
    const double determinant = std::abs(map.determinant());
    return std::max({b.cross(c).length(), c.cross(a).length(), a.cross(b).length()}) / determinant;
}

}  // namespace

bool isTooSmall(const Affine& toWorld) {
    return toWorld.invertible() && inverseScale(toWorld) > kMostInverse;
}

void requireTraceable(const TriangleMesh& mesh, const std::string& owner) {
    std::map<std::uint32_t, Box3d> boxes;
    for (const MeshInstance& instance : mesh.instances) {
        auto found = boxes.find(instance.firstPart);
        if (found == boxes.end())
            found = boxes.emplace(instance.firstPart, localBounds(mesh, instance)).first;
        const auto fail = [&](const std::string& cause) {
            throw Error(fmt::format("{}: instance {}: {}", owner, instance.source, cause));
        };
        if (!staysInReach(instance.toWorld, found->second))
            fail(fmt::format("out of reach, expected coordinates within {:g} of the set",
                             kMostCoordinate));
        if (isTooSmall(instance.toWorld))
            fail(fmt::format("scaled by {:g}, expected at least {:g}",
                             1 / inverseScale(instance.toWorld), 1 / kMostInverse));
    }
}

}  // namespace shadowcache
