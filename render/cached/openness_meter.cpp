#include "render/cached/openness_meter.h"

namespace shadowcache {

OpennessMeter::OpennessMeter(const DirectionTiers& tiers) {
    const int level = tiers.baseLevel();
    for (std::uint32_t cell = 0; cell < tiers.baseCells(); ++cell)
        baseCells_.emplace_back(cellCenter(level, cell) * solidAngle(cellTriangle(level, cell)));
}

float OpennessMeter::measure(const PooledVisibility& pooled, const Vec3f& normal) const {
    float visible = 0, all = 0;
    for (std::uint32_t cell = 0; cell < baseCells_.size(); ++cell) {
        const PooledBlock& block = pooled.base(cell / kBlockCells);
        const int i = static_cast<int>(cell % kBlockCells);
        const float cosine = baseCells_[cell].dot(normal);
        if (cosine <= 0 || block.weight[i] <= 0) continue;
        visible += cosine * block.ratio(i);
        all += cosine;
    }
    return all > 0 ? visible / all : 0.0f;
}

}  // namespace shadowcache
