#include "bake/core/placement.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>

#include "common/base/error.h"
#include "common/base/parallel.h"
#include "common/mesh/placed_mesh.h"

namespace shadowcache {

namespace {

constexpr int kLeafBits = 17;  // 8^3 leaves along an axis
constexpr int kMaxVoxels = 1 << (kLeafBits + 3);

Vec3i floorVector(const Vec3d& v) {
    return {static_cast<int>(std::floor(v.x)), static_cast<int>(std::floor(v.y)),
            static_cast<int>(std::floor(v.z))};
}

std::string refusal(double spacing, double least) {
    std::ostringstream text;
    text << "--spacing " << spacing << ": too small for this set, expected at least " << least;
    return text.str();
}

/// Keeps the part of `polygon` where sign * (corner[axis] - limit) <= 0.
void clipAxis(Polygon& polygon, int axis, double limit, double sign) {
    Polygon out;
    for (std::size_t i = 0; i < polygon.count; ++i) {
        const Vec3d& a = polygon.corner[i];
        const Vec3d& b = polygon.corner[(i + 1) % polygon.count];
        const double da = sign * (a[axis] - limit), db = sign * (b[axis] - limit);
        if (da <= 0) out.corner[out.count++] = a;
        if ((da < 0 && db > 0) || (da > 0 && db < 0))
            out.corner[out.count++] = a + (b - a) * (da / (da - db));
    }
    polygon = out;
}

Polygon wholeTriangle(const TriangleMesh& mesh, std::uint32_t triangle) {
    Polygon polygon;
    for (const Vec3d& corner : placedCorners(mesh, triangle))
        polygon.corner[polygon.count++] = corner;
    return polygon;
}

/// Cuts triangles along the voxels.
class FragmentCutter {
public:
    FragmentCutter(const TriangleMesh& mesh, const VoxelFrame& frame, const VoxelKeys* only)
        : mesh_(mesh), frame_(frame), only_(only) {}

    void cut(std::uint32_t triangle, std::vector<Fragment>& out) const {
        const Polygon polygon = wholeTriangle(mesh_, triangle);
        const Range range = voxelsOf(polygon);
        if (mayTouch(range)) addSlabs(polygon, range, 0, triangle, out);
    }

private:
    /// Voxels `first` to `last` along each axis.
    struct Range {
        Vec3i first, last;
    };

    /// Whether a voxel of the range may be one of those to place fragments in.
    bool mayTouch(const Range& range) const {
        return !only_ || only_->mayTouch(range.first, range.last,
                                         [&](const Vec3i& voxel) { return frame_.key(voxel); });
    }

    Range voxelsOf(const Polygon& polygon) const {
        Imath::Box3d box;
        for (std::size_t i = 0; i < polygon.count; ++i) box.extendBy(polygon.corner[i]);
        return {frame_.voxelAt(box.min), frame_.voxelAt(box.max)};
    }

    /// Cuts `polygon` into slabs of voxels along `axis`, then each slab along the next one, so that
    /// the work follows the triangle and not its bounding box. Along the axes before, `range` is
    /// the voxel.
    void addSlabs(const Polygon& polygon, const Range& range, int axis, std::uint32_t triangle,
                  std::vector<Fragment>& out) const {
        if (axis == 3) return addFragment(polygon, range.first, triangle, out);
        for (int v = range.first[axis]; v <= range.last[axis]; ++v) {
            Range part = range;
            part.first[axis] = part.last[axis] = v;
            if (!mayTouch(part)) continue;
            Polygon slab = polygon;
            const double middle = frame_.center(part.first)[axis], half = frame_.spacing() / 2;
            if (v < range.last[axis]) clipAxis(slab, axis, middle + half, 1);
            if (v > range.first[axis]) clipAxis(slab, axis, middle - half, -1);
            if (slab.count == 0) continue;
            const Range exact = voxelsOf(slab);
            for (int later = axis + 1; later < 3; ++later) {
                part.first[later] = exact.first[later];
                part.last[later] = exact.last[later];
            }
            addSlabs(slab, part, axis + 1, triangle, out);
        }
    }

    void addFragment(const Polygon& polygon, const Vec3i& voxel, std::uint32_t triangle,
                     std::vector<Fragment>& out) const {
        const double size = area(polygon);
        // An area below float's range still makes an item.
        if (size > 0)
            out.push_back(
                {frame_.key(voxel), triangle, std::max(static_cast<float>(size), 1e-37f)});
    }

    const TriangleMesh& mesh_;
    const VoxelFrame& frame_;
    const VoxelKeys* only_;
};

bool isBefore(const Fragment& a, const Fragment& b) {
    return a.voxelKey != b.voxelKey ? a.voxelKey < b.voxelKey : a.triangle < b.triangle;
}

}  // namespace

VoxelFrame::VoxelFrame(const TriangleMesh& mesh, double spacing)
    : spacing_(spacing), origin_(mesh.origin) {
    const Imath::Box3d box = placedBounds(mesh);
    const Vec3d low = (box.min + origin_) / spacing, high = (box.max + origin_) / spacing;
    const Vec3d size = high - low;
    const double most = std::max({size.x, size.y, size.z});
    const double farthest = std::max({std::abs(low.x), std::abs(low.y), std::abs(low.z),
                                      std::abs(high.x), std::abs(high.y), std::abs(high.z)});
    if (most > kMaxVoxels - 16 || farthest > 2e9)
        throw Error(refusal(spacing, spacing * std::max(most / (kMaxVoxels - 16), farthest / 2e9)));
    const Vec3i v = floorVector(low);
    base_ = {(v.x & ~7) - 8, (v.y & ~7) - 8, (v.z & ~7) - 8};
}

std::uint64_t VoxelFrame::key(const Vec3i& voxel) const {
    const Vec3i v = voxel - base_;
    const auto bits = [](int value) { return static_cast<std::uint64_t>(value); };
    const std::uint64_t leaf =
        (((bits(v.x) >> 3) << kLeafBits | bits(v.y) >> 3) << kLeafBits) | bits(v.z) >> 3;
    return leaf << 9 | (bits(v.x) & 7) << 6 | (bits(v.y) & 7) << 3 | (bits(v.z) & 7);
}

bool VoxelFrame::holds(const Vec3i& voxel) const {
    for (int axis = 0; axis < 3; ++axis) {
        const auto at = std::int64_t{voxel[axis]} - base_[axis];
        if (at < 0 || at >= kMaxVoxels) return false;
    }
    return true;
}

Vec3i VoxelFrame::voxel(std::uint64_t key) const {
    const std::uint64_t leaf = key >> 9, mask = (1u << kLeafBits) - 1;
    const auto axis = [&](int shift, int low) {
        return static_cast<int>(((leaf >> shift) & mask) << 3 | ((key >> low) & 7));
    };
    return base_ + Vec3i(axis(2 * kLeafBits, 6), axis(kLeafBits, 3), axis(0, 0));
}

Vec3i VoxelFrame::voxelAt(const Vec3d& position) const {
    return floorVector((position + origin_) / spacing_ + Vec3d(0.5));
}

Vec3d VoxelFrame::center(const Vec3i& voxel) const {
    return Vec3d(voxel) * spacing_ - origin_;
}

Box VoxelFrame::box(const Vec3i& voxel) const {
    return {center(voxel), Vec3d(spacing_ / 2)};
}

Polygon clipToBox(const TriangleMesh& mesh, std::uint32_t triangle, const Box& box) {
    Polygon polygon = wholeTriangle(mesh, triangle);
    for (int axis = 0; axis < 3 && polygon.count > 0; ++axis) {
        clipAxis(polygon, axis, box.center[axis] + box.half[axis], 1);
        clipAxis(polygon, axis, box.center[axis] - box.half[axis], -1);
    }
    return polygon;
}

double area(const Polygon& polygon) {
    Vec3d sum(0, 0, 0);
    for (std::size_t i = 2; i < polygon.count; ++i)
        sum += (polygon.corner[i - 1] - polygon.corner[0])
                   .cross(polygon.corner[i] - polygon.corner[0]);
    return sum.length() / 2;
}

void cutTriangle(const TriangleMesh& mesh, const VoxelFrame& frame, std::uint32_t triangle,
                 std::vector<Fragment>& out) {
    FragmentCutter(mesh, frame, nullptr).cut(triangle, out);
}

std::vector<Fragment> placeFragments(const TriangleMesh& mesh, const VoxelFrame& frame,
                                     const VoxelKeys* only) {
    constexpr std::size_t kChunkSize = 4096;
    const FragmentCutter cutter(mesh, frame, only);
    const std::size_t count = placedCount(mesh);
    std::vector<std::vector<Fragment>> parts((count + kChunkSize - 1) / kChunkSize);
    parallelFor(count, kChunkSize, [&](const Chunk& chunk) {
        std::vector<Fragment>& out = parts[chunk.index];
        for (std::size_t i = chunk.begin; i < chunk.end; ++i)
            cutter.cut(static_cast<std::uint32_t>(i), out);
        std::sort(out.begin(), out.end(), isBefore);
    });
    std::size_t total = 0;
    for (const auto& part : parts) total += part.size();
    std::vector<Fragment> fragments;
    fragments.reserve(total);
    for (auto& part : parts) {
        fragments.insert(fragments.end(), part.begin(), part.end());
        std::vector<Fragment>().swap(part);
    }
    std::sort(fragments.begin(), fragments.end(), isBefore);
    return fragments;
}

}  // namespace shadowcache
