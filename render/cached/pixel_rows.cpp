#include "render/cached/pixel_rows.h"

#include <algorithm>
#include <cassert>

namespace shadowcache {

void PixelRows::assign(const PointBatch& batch) {
    points_ = batch.points;
    pixels_ = batch.pixels;
    rows_ = 0;
    for (const ShadingPoint& point : points_) rows_ = std::max(rows_, point.slot.row + 1);
    firstPoint_.assign(std::size_t{rows_} * pixels_, kNone);
    for (std::uint32_t i = 0; i < points_.size(); ++i) {
        const BatchSlot& slot = points_[i].slot;
        std::uint32_t& first = firstPoint_[std::size_t{slot.row} * pixels_ + slot.pixel];
        if (first == kNone)
            first = i;
        else
            assert(points_[i - 1].slot.pixel == slot.pixel && points_[i - 1].slot.row == slot.row);
    }
}

}  // namespace shadowcache
