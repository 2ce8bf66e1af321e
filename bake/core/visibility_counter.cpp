#include "bake/core/visibility_counter.h"

#include <algorithm>
#include <limits>

#include "common/base/hash.h"

namespace shadowcache {

namespace {

/// Bits of all cells of an octet.
constexpr std::uint32_t kAll = (1u << DirectionTable::kCells) - 1;

}  // namespace

DirectionTable::DirectionTable() {
    for (int level = 0; level <= kMaxCacheLevel; ++level) {
        auto& octets = octets_[static_cast<std::size_t>(level)];
        octets.resize((cellCount(level) + kCells - 1) / kCells);
        for (std::uint32_t c = 0; c < cellCount(level); ++c) {
            Octet& o = octets[c / kCells];
            const SphericalTriangle t = cellTriangle(level, c);
            for (int axis = 0; axis < 3; ++axis) {
                o.corner[axis][c % kCells] = static_cast<float>(t.a[axis]);
                o.side1[axis][c % kCells] = static_cast<float>(t.b[axis] - t.a[axis]);
                o.side2[axis][c % kCells] = static_cast<float>(t.c[axis] - t.a[axis]);
            }
        }
    }
    for (std::uint32_t i = 0; i < kPoints; ++i) {
        // Each two bits choose one of the three triangles at the corners or, for 3, the turned one
        // in the middle.
        float x = 0, y = 0, size = 1;
        for (int shift = 6; shift >= 0; shift -= 2) {
            const std::uint32_t part = i >> shift & 3;
            size /= 2;
            if (part & 1) x += size;
            if (part & 2) y += size;
            if (part == 3) size = -size;
        }
        points_[i] = {x + size / 3, y + size / 3};
    }
}

VisibilityCounter::VisibilityCounter(const Scene& scene, const DirectionTable& directions,
                                     const Patch& patch, std::uint64_t seed)
    : scene_(scene), directions_(directions), patch_(patch), state_(seed) {}

void VisibilityCounter::add(int level, std::uint32_t octet, std::uint32_t cells, int count,
                            Count* tallies, OriginPairs* pairs) {
    // Strata of the points, in 2^-16 of one.
    const std::uint32_t step =
        (DirectionTable::kPoints << 16) / static_cast<std::uint32_t>(std::max(1, count));
    for (int i = 0; i < count; ++i)
        addOne(directions_.octet(level, octet), cells, static_cast<std::uint32_t>(i) * step, step,
               tallies, pairs);
}

/// One ray a cell. All start at one point, and those into one cell each at another: Embree traces
/// rays that stay together a third faster. All go to the same point of their cells: a lattice with
/// a random shift.
void VisibilityCounter::addOne(const DirectionTable::Octet& octet, std::uint32_t cells,
                               std::uint32_t firstPoint, std::uint32_t points, Count* tallies,
                               OriginPairs* pairs) {
    if (rays_ + kCells > RayStream::kSize) flush();
    const std::uint64_t random = mixBits(state_ += 0x9e3779b97f4a7c15ull);
    const std::size_t start = random % Patch::kOrigins;
    const DirectionTable::Point& point = directions_.point(
        (firstPoint + static_cast<std::uint32_t>((random >> 56) * points >> 8)) >> 16);

    // Loops over eight floats each, which the compiler turns into one vector.
    alignas(32) float direction[3][kCells];
    for (int axis = 0; axis < 3; ++axis)
        for (std::uint32_t k = 0; k < kCells; ++k)
            direction[axis][k] = octet.corner[axis][k] + octet.side1[axis][k] * point.along1 +
                                 octet.side2[axis][k] * point.along2;
    const Vec3f normal = patch_.originNormal[start];
    alignas(32) std::uint32_t bit[kCells];
    for (std::uint32_t k = 0; k < kCells; ++k) {
        const float cosine =
            direction[0][k] * normal.x + direction[1][k] * normal.y + direction[2][k] * normal.z;
        bit[k] = cosine > 0 ? 1u << k : 0u;
    }
    for (std::uint32_t half = kCells / 2; half > 0; half /= 2)
        for (std::uint32_t k = 0; k < half; ++k) bit[k] |= bit[k + half];

    queue_[queued_] = {tallies, pairs, rays_, cells & bit[0]};
    append(direction, patch_.origin[start]);
}

/// Appends the rays of the last entry of the queue to the stream.
inline void VisibilityCounter::append(const float (&direction)[3][kCells], const Vec3f& origin) {
    const std::uint32_t cells = queue_[queued_].cells;
    for (int axis = 0; axis < 3; ++axis)
        std::fill_n(stream_.origin[axis] + rays_, kCells, origin[axis]);
    std::fill_n(stream_.reach + rays_, kCells, std::numeric_limits<float>::infinity());
    queued_ += cells != 0 ? 1u : 0u;
    if (cells == kAll) {
        for (int axis = 0; axis < 3; ++axis)
            std::copy_n(direction[axis], kCells, stream_.direction[axis] + rays_);
        rays_ += kCells;
        return;
    }
    for (std::uint32_t k = 0; k < kCells; ++k) {
        for (int axis = 0; axis < 3; ++axis) stream_.direction[axis][rays_] = direction[axis][k];
        rays_ += cells >> k & 1u;
    }
}

void VisibilityCounter::flush() {
    if (rays_ == 0) return;
    scene_.trace(stream_, rays_);
    for (std::size_t q = 0; q < queued_; ++q) {
        const Queued& octet = queue_[q];
        const float* reach = stream_.reach + octet.first;
        std::uint32_t counted = kCells, visible = 0;
        if (octet.cells == kAll) {
            for (std::uint32_t k = 0; k < kCells; ++k) {
                const std::uint32_t one = reach[k] >= 0 ? 1 : 0;
                octet.tallies[k].word += one * Count::kVisible + Count::kRay;
                visible += one;
            }
        } else {
            counted = 0;
            for (std::uint32_t k = 0; k < kCells; ++k) {
                if ((octet.cells >> k & 1u) == 0) continue;
                const std::uint32_t one = reach[counted++] >= 0 ? 1 : 0;
                octet.tallies[k].word += one * Count::kVisible + Count::kRay;
                visible += one;
            }
        }
        if (octet.pairs) {
            octet.pairs->counted += counted * (counted - 1);
            octet.pairs->visible += visible * (visible - 1);
        }
    }
    traced_ += rays_;
    rays_ = 0;
    queued_ = 0;
}

}  // namespace shadowcache
