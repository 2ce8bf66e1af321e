#pragma once

#include <cstdint>
#include <vector>

#include "render/estimators/shading_point.h"

namespace shadowcache {

/// The points of a batch by row and pixel. Those of one row and pixel follow one another.
class PixelRows {
public:
    /// Becomes that of a batch, which is read as long as points are asked for.
    void assign(const PointBatch& batch);

    std::uint32_t rows() const { return rows_; }
    std::uint32_t pixels() const { return pixels_; }

    /// Calls `visit` with the number of each point of a row whose pixel is `first` or above and
    /// below `end`.
    template <class Visit>
    void forEachPoint(std::uint32_t row, std::uint32_t first, std::uint32_t end,
                      const Visit& visit) const {
        const std::uint32_t* firstPoints = firstPoint_.data() + std::size_t{row} * pixels_;
        for (std::uint32_t pixel = first; pixel < end; ++pixel)
            for (std::uint32_t point = firstPoints[pixel];
                 point < points_.size() && points_[point].slot.pixel == pixel &&
                 points_[point].slot.row == row;
                 ++point)
                visit(point);
    }

private:
    static constexpr std::uint32_t kNone = 0xffffffff;

    std::span<const ShadingPoint> points_;
    std::uint32_t pixels_ = 0, rows_ = 0;
    std::vector<std::uint32_t> firstPoint_;  ///< of a row and pixel, or kNone
};

}  // namespace shadowcache
