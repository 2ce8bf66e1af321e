#include "bake/core/base_cells.h"

#include <algorithm>
#include <cmath>

namespace shadowcache {

BaseCells::BaseCells(const DirectionTiers& tiers) {
    for (std::uint32_t c = 0; c < tiers.baseCells(); ++c) {
        const CellCap cap = cellCap(tiers.baseLevel(), c);
        axis.emplace_back(cap.axis);
        radius.push_back(static_cast<float>(cap.angle));
    }
}

std::vector<std::uint32_t> BaseCells::above(const Patch& patch) const {
    const float spread = std::acos(std::clamp(patch.minAgreement, -1.0f, 1.0f));
    std::vector<std::uint32_t> cells;
    for (std::uint32_t c = 0; c < axis.size(); ++c) {
        const float angle = std::acos(std::clamp(axis[c].dot(patch.normal), -1.0f, 1.0f));
        if (angle < static_cast<float>(kPi / 2) + spread + radius[c]) cells.push_back(c);
    }
    return cells;
}

}  // namespace shadowcache
