#include "common/import/local_space.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "common/math/limits.h"

namespace shadowcache {

namespace {

/// So many times a group's size away from its origin, and its coordinates are shifted: nearer,
/// float has bits to spare.
constexpr double kFar = 16;

/// And so many times smaller or larger than 1, and they are scaled: Embree's numbers have a range.
constexpr double kOdd = 1024;

/// Boxes of the groups' faces, in their own spaces.
std::map<int, Box3d> boxes(const RawMesh& raw) {
    std::map<int, Box3d> found;
    std::size_t face = 0, corner = 0;
    for (const RawPart& part : raw.parts) {
        Box3d& box = found[part.group];
        for (const std::size_t end = face + part.faceCount; face < end; ++face)
            for (const std::size_t last = corner + raw.faceSizes[face]; corner < last; ++corner) {
                const std::uint32_t v = raw.faceVertices[corner];
                if (v < raw.vertices.size() && isInReach(raw.vertices[v]))
                    box.extendBy(raw.vertices[v]);
            }
    }
    found.erase(0);
    return found;
}

/// From the new space of a group to that of its file. Shifts are floats and scales powers of two,
/// so that what a file has in float stays exact.
Affine spaceOf(const Box3d& box) {
    Affine space;
    if (box.isEmpty()) return space;
    const Vec3d size = box.size();
    const double half = std::max({size.x, size.y, size.z}) / 2;
    if (half == 0) return space;
    for (int k = 0; k < 3; ++k)
        if (std::abs(box.center()[k]) > kFar * half)
            space.position[k] = static_cast<double>(static_cast<float>(box.center()[k]));
    const bool odd = half > kOdd || half < 1 / kOdd;
    const double scale = odd ? std::exp2(std::round(std::log2(half))) : 1;
    for (int k = 0; k < 3; ++k) space.axis[static_cast<std::size_t>(k)] *= scale;
    return space;
}

}  // namespace

void bringNearOrigin(RawMesh& raw) {
    std::map<int, Affine> spaces;
    for (const auto& [group, box] : boxes(raw)) spaces[group] = spaceOf(box);
    std::vector<bool> done(raw.vertices.size(), false);
    std::size_t face = 0, corner = 0;
    for (const RawPart& part : raw.parts) {
        const auto space = spaces.find(part.group);
        for (const std::size_t end = face + part.faceCount; face < end; ++face)
            for (const std::size_t last = corner + raw.faceSizes[face]; corner < last; ++corner) {
                const std::uint32_t v = raw.faceVertices[corner];
                if (space == spaces.end() || v >= done.size() || done[v]) continue;
                done[v] = true;
                if (!isInReach(raw.vertices[v])) continue;  // such faces are dropped
                const Affine& a = space->second;
                raw.vertices[v] = (raw.vertices[v] - a.position) / a.axis[0].x;
            }
    }
    for (RawInstance& instance : raw.instances) {
        const auto space = spaces.find(instance.group);
        if (space == spaces.end()) continue;
        instance.toGroup = space->second;
        instance.toWorld = compose(instance.toWorld, space->second);
    }
}

}  // namespace shadowcache
