#include "common/predict/cell_splits.h"

namespace shadowcache {

namespace {

/// Noise of a cell, as a share of the sky's luminance integral, from which on it is split: because
/// it is partly occluded, or because on the horizon a quadratic replaces the clamped cosine.
constexpr float kLeastNoise = 5e-4f;

}  // namespace

CellSplitter::CellSplitter(const Environment& environment, const DirectionTiers& tiers)
    : tiers_(tiers),
      finest_(Environment::kLevel - (tiers.baseLevel() == Environment::kLevel % 2 ? 0 : 1)),
      leastNoise_(kLeastNoise * static_cast<float>(environment.luminanceIntegral())) {}

bool CellSplitter::decide(int tier, const CellLight& sky, const float* c, float leastNoise,
                          std::uint8_t* uncertain, Splits& out) const {
    out.any = false;
    const bool divisible = tiers_.baseLevel() + 2 * tier < finest_;
    const bool refined = tier < tiers_.refinements();
    if (!divisible || !(refined || sky.anyHorizon)) return false;
    const float scale = 1 / leastNoise;
    for (int i = 0; i < kBlockCells; ++i) {
        const float square = sky.light[i] * scale * (sky.light[i] * scale);
        const float uncertainty = square * c[i] * (1 - c[i]);
        const float noise = square * c[i] * c[i] * (sky.cosineMoment[i] - sky.fitMoment[i]);
        uncertain[i] = refined && uncertainty > 1 ? 1 : 0;
        out.marks[i] = noise > 1 ? 1 : 0;
    }
    return true;
}

}  // namespace shadowcache
