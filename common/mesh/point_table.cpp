#include "common/mesh/point_table.h"

#include <bit>
#include <limits>

#include "common/base/hash.h"

namespace shadowcache {

namespace {

constexpr std::uint32_t kEmpty = std::numeric_limits<std::uint32_t>::max();

std::uint64_t hashPoint(const Vec3f& p) {
    const std::uint64_t xy = (std::uint64_t{std::bit_cast<std::uint32_t>(p.x)} << 32) |
                             std::bit_cast<std::uint32_t>(p.y);
    return mixBits(mixBits(xy) + std::bit_cast<std::uint32_t>(p.z));
}

/// Bit by bit, so that a NaN is itself.
bool same(const Vec3f& a, const Vec3f& b) {
    const auto equal = [](float x, float y) {
        return std::bit_cast<std::uint32_t>(x) == std::bit_cast<std::uint32_t>(y);
    };
    return equal(a.x, b.x) && equal(a.y, b.y) && equal(a.z, b.z);
}

}  // namespace

PointTable::PointTable(std::size_t expectedPoints)
    : slots_(std::bit_ceil(expectedPoints + expectedPoints / 2 + 8), kEmpty) {}

std::uint32_t PointTable::add(const Vec3f& point) {
    const Vec3f key = point + Vec3f(0.0f);
    if (points_.size() + points_.size() / 2 >= slots_.size()) grow();
    const std::size_t mask = slots_.size() - 1;
    for (std::size_t slot = hashPoint(key) & mask;; slot = (slot + 1) & mask) {
        if (slots_[slot] == kEmpty) {
            slots_[slot] = static_cast<std::uint32_t>(points_.size());
            points_.push_back(key);
            return slots_[slot];
        }
        if (same(points_[slots_[slot]], key)) return slots_[slot];
    }
}

void PointTable::grow() {
    slots_.assign(slots_.size() * 2, kEmpty);
    const std::size_t mask = slots_.size() - 1;
    for (std::size_t i = 0; i < points_.size(); ++i) {
        std::size_t slot = hashPoint(points_[i]) & mask;
        while (slots_[slot] != kEmpty) slot = (slot + 1) & mask;
        slots_[slot] = static_cast<std::uint32_t>(i);
    }
}

}  // namespace shadowcache
