#include "render/cached/region_index.h"

#include <algorithm>

namespace shadowcache {

void RegionIndex::build(const Regions& regions) {
    for (const auto& [level, block] : used_) groups_[level][block] = -1;
    used_.clear();
    coarsest_ = Environment::kLevel;
    finest_ = -1;
    for (std::size_t g = 0; g < regions.groups.size(); ++g) {
        const RegionGroup& group = regions.groups[g];
        std::vector<std::int16_t>& groups = groups_[group.level];
        if (groups.empty()) groups.assign(cellCount(group.level) / kBlockCells + 1, -1);
        const std::uint32_t block = group.firstCell / kBlockCells;
        groups[block] = static_cast<std::int16_t>(g);
        used_.emplace_back(group.level, block);
        coarsest_ = std::min(coarsest_, group.level);
        finest_ = std::max(finest_, group.level);
    }
}

RegionIndex::Place RegionIndex::find(const Regions& regions, std::uint32_t cell) const {
    for (int level = coarsest_; level <= finest_; ++level) {
        if (groups_[level].empty()) continue;
        const std::uint32_t ancestor = ancestorCell(cell, Environment::kLevel, level);
        const std::int16_t group = groups_[level][ancestor / kBlockCells];
        const auto lane = static_cast<int>(ancestor % kBlockCells);
        if (group >= 0 && regions.groups[static_cast<std::size_t>(group)].light[lane] > 0)
            return {group, lane};
    }
    return {};
}

}  // namespace shadowcache
