#include "render/sensors/sky_patches.h"

#include <algorithm>

#include "common/base/parallel.h"
#include "common/predict/cell_light.h"

namespace shadowcache {

namespace {

/// Patches that a thread takes at a time.
constexpr std::size_t kChunk = 64;

}  // namespace

std::vector<Vec3d> lightOfPatches(const Environment& environment, int level) {
    std::vector<Vec3d> light(cellCount(level), Vec3d(0.0));
    const std::uint32_t parts = cellCount(Environment::kLevel) / cellCount(level);
    parallelFor(light.size(), kChunk, [&](const Chunk& chunk) {
        for (std::size_t patch = chunk.begin; patch < chunk.end; ++patch) {
            const auto first = static_cast<std::uint32_t>(patch) * parts;
            for (std::uint32_t cell = first; cell < first + parts; ++cell)
                environment.forEachTexel(cell, [&](std::uint32_t i) {
                    const Environment::Texel texel = environment.texel(i);
                    light[patch] += Vec3d(texel.radiance) * static_cast<double>(texel.solidAngle);
                });
        }
    });
    return light;
}

PatchCosines::PatchCosines() : white_({1, 1, {Rgb(1, 1, 1)}}, 0, Rgb(0.25f, 0.5f, 0.25f)) {}

void PatchCosines::at(int level, const Vec3f& normal, std::span<float> out) const {
    CellLight light;
    for (std::size_t first = 0; first < out.size(); first += kBlockCells) {
        const auto block = static_cast<std::uint32_t>(first / kBlockCells);
        lightCells(white_.cells(level, block), normal, white_.luminanceWeights(), light);
        const std::size_t count = std::min<std::size_t>(kBlockCells, out.size() - first);
        for (std::size_t i = 0; i < count; ++i) {
            const float whole = solidAngle(level, static_cast<std::uint32_t>(first + i));
            out[first + i] = std::max(0.0f, light.irradiance[0][i]) / whole;
        }
    }
}

}  // namespace shadowcache
