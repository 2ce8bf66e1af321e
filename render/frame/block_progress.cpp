#include "render/frame/block_progress.h"

#include <algorithm>
#include <utility>

namespace shadowcache {

BlockProgress::BlockProgress(std::size_t tiles, std::size_t work,
                             std::function<void(std::size_t)> onTiles)
    : tiles_(tiles), work_(std::max<std::size_t>(1, work)), onTiles_(std::move(onTiles)) {}

void BlockProgress::add(std::size_t work) {
    const std::size_t before = done_.fetch_add(work);
    const std::size_t more = tilesAt(before + work) - tilesAt(before);
    if (more > 0) onTiles_(more);
}

void BlockProgress::finish() {
    add(work_ - std::min(work_, done_.load()));
}

std::size_t BlockProgress::tilesAt(std::size_t work) const {
    return tiles_ * std::min(work, work_) / work_;
}

}  // namespace shadowcache
