#include "bake/core/placement.h"

#include <algorithm>
#include <cmath>

#include "bake/core/repeated_triangles.h"
#include "common/base/parallel.h"
#include "common/mesh/placed_mesh.h"

namespace shadowcache {

namespace {

/// Keeps the part of `polygon` where sign * (corner[axis] - limit) <= 0.
void clipAxis(Polygon& polygon, int axis, double limit, double sign) {
    const auto isOutside = [&](const Vec3d& corner) { return sign * (corner[axis] - limit) > 0; };
    const auto corners = std::span(polygon.corner).first(polygon.count);
    if (std::ranges::none_of(corners, isOutside)) return;
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
        if (!only_ || only_->mayTouch(frame_, range.first, range.last))
            addSlabs(polygon, range, 0, triangle, out);
    }

private:
    /// Voxels `first` to `last` along each axis.
    struct Range {
        Vec3i first, last;
    };

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
        if (range.first[axis] == range.last[axis]) {
            if (!only_ || only_->mayTouch(frame_, range.first, range.last))
                addSlabs(polygon, range, axis + 1, triangle, out);
            return;
        }
        for (int v = range.first[axis]; v <= range.last[axis]; ++v) {
            Range part = range;
            part.first[axis] = part.last[axis] = v;
            if (only_ && !only_->mayTouch(frame_, part.first, part.last)) continue;
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
    const std::vector<bool> repeated = repeatedTriangles(mesh);
    std::vector<std::vector<Fragment>> parts((count + kChunkSize - 1) / kChunkSize);
    parallelFor(count, kChunkSize, [&](const Chunk& chunk) {
        std::vector<Fragment>& out = parts[chunk.index];
        for (std::size_t i = chunk.begin; i < chunk.end; ++i)
            if (i >= repeated.size() || !repeated[i])
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
