#include "render/cached/glossy_regions.h"

#include <algorithm>
#include <cmath>

#include "common/base/parallel.h"
#include "common/base/tuned.h"

namespace shadowcache {

namespace {

/// Share of the samples that follow the light alone.
SHADOWCACHE_TUNED(double, kPlainShare, 0.2);

constexpr std::size_t kCellsPerChunk = 256;

}  // namespace

TexelCells::TexelCells(const Environment& environment) : cells_(environment.texelCount()) {
    parallelFor(cellCount(Environment::kLevel), kCellsPerChunk, [&](const Chunk& chunk) {
        for (std::size_t cell = chunk.begin; cell < chunk.end; ++cell) {
            const auto [first, end] = environment.texelsOf(static_cast<std::uint32_t>(cell));
            for (std::size_t i = first; i < end; ++i)
                cells_[environment.texel(i).index] = static_cast<std::uint16_t>(cell);
        }
    });
}

GlossyRegions::GlossyRegions(const Environment& environment) : environment_(environment) {
    for (int level = 0; level <= Environment::kLevel; ++level)
        perLight_[static_cast<std::size_t>(level)].assign(cellCount(level), 0.0f);
}

bool GlossyRegions::build(const Regions& regions, const GlossyLobe& lobe, const TexelCells& cells) {
    cells_ = &cells;
    for (const Entry& e : entries_) perLight_[static_cast<std::size_t>(e.level)][e.cell] = 0;
    entries_.clear();
    used_ = {};
    double guided = 0, plain = 0;
    for (const RegionGroup& group : regions.groups) {
        const CellMoments& m = environment_.cells(group.level, group.firstCell / kBlockCells);
        for (std::uint32_t i = 0; i < kBlockCells; ++i) {
            if (!(group.deviation[i] > 0)) continue;
            const std::uint32_t cell = group.firstCell + i;
            const double light = environment_.luminanceIntegral(group.level, cell);
            if (!(light > 0)) continue;
            const Rgb reflected = lobe.value({m.axis[0][i], m.axis[1][i], m.axis[2][i]});
            const double weight =
                light * std::max(0.0, static_cast<double>(environment_.luminance(reflected))) *
                std::sqrt(static_cast<double>(group.calibrated[i]));
            entries_.push_back({group.level, cell, weight, light});
            guided += weight;
            plain += light;
        }
    }
    begin_.assign(1, 0.0);
    const double ofGuided = guided > 0 ? (1 - kPlainShare) / guided : 0,
                 ofPlain = (guided > 0 ? kPlainShare : 1) / plain;
    for (const Entry& e : entries_) {
        const double probability = e.guided * ofGuided + e.plain * ofPlain;
        begin_.push_back(begin_.back() + probability);
        const auto level = static_cast<std::size_t>(e.level);
        used_[level] = true;
        perLight_[level][e.cell] = static_cast<float>(probability / e.plain);
    }
    return !entries_.empty();
}

EnvironmentSample GlossyRegions::sample(double u, float jitterX, float jitterY) const {
    const double at = u * begin_.back();
    const auto next = std::upper_bound(begin_.begin() + 1, begin_.end() - 1, at);
    const auto k = static_cast<std::size_t>(next - begin_.begin()) - 1;
    const double size = begin_[k + 1] - begin_[k];
    const double rest = std::clamp((at - begin_[k]) / size, 0.0, 0x1.fffffffffffffp-1);
    const Entry& e = entries_[k];
    EnvironmentSample s = environment_.sampleCell(e.level, e.cell, rest, jitterX, jitterY);
    s.density *= static_cast<float>(size / begin_.back());
    return s;
}

float GlossyRegions::density(const EnvironmentSample& s) const {
    const std::uint32_t cell = cells_->cell(s.texel);
    for (int level = 0; level <= Environment::kLevel; ++level) {
        if (!used_[static_cast<std::size_t>(level)]) continue;
        const float perLight = perLight_[static_cast<std::size_t>(level)]
                                        [ancestorCell(cell, Environment::kLevel, level)];
        // Within a cell samples follow the light, as those of the whole map do.
        if (perLight > 0)
            return perLight * s.density * static_cast<float>(environment_.luminanceIntegral());
    }
    return 0;
}

}  // namespace shadowcache
