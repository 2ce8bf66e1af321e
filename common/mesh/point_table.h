#pragma once

#include <cstdint>
#include <vector>

#include "common/math/vec.h"

namespace shadowcache {

/// Numbers distinct points in the order of their first appearance; points are the same if their
/// bits are, save that -0 is 0.
class PointTable {
public:
    explicit PointTable(std::size_t expectedPoints);

    /// Number of `point`, which is new if it equals points().size() before the call.
    std::uint32_t add(const Vec3f& point);

    const std::vector<Vec3f>& points() const { return points_; }

private:
    void grow();

    std::vector<Vec3f> points_;
    std::vector<std::uint32_t> slots_;  ///< open addressing, a power of two, at most 2/3 full
};

}  // namespace shadowcache
