#include "common/predict/cell_light.h"

#include <cmath>
#include <cstdint>

#include "common/predict/horizon.h"
#include "common/predict/lanes.h"

namespace shadowcache {

namespace {

/// Replaces the light of those cells that the horizon cuts. All sixteen are computed: that is
/// faster than one by one.
void lightHorizon(const CellMoments& m, const Vec3f& n, const float* height, CellLight& out) {
    alignas(64) float constant[kBlockCells], linear[kBlockCells], square[kBlockCells];
    alignas(64) std::int32_t cut[kBlockCells];
    for (int i = 0; i < kBlockCells; ++i) {
        cut[i] = std::abs(height[i]) < m.sinRadius[i];
        const float radius = m.sinRadius[i] > 1e-9f ? m.sinRadius[i] : 1e-9f;
        const HorizonFit fit(cut[i] ? height[i] : 0.0f, radius);
        constant[i] = fit.constant;
        linear[i] = fit.linear;
        square[i] = fit.square;
        out.light[i] = cut[i] ? m.luminanceIntegral[i] : out.light[i];
        out.cosineMoment[i] = cut[i] ? fit.cosineMoment : out.cosineMoment[i];
        out.fitMoment[i] = cut[i] ? fit.fitMoment : out.fitMoment[i];
    }
    const float xx = n.x * n.x, yy = n.y * n.y, zz = n.z * n.z;
    const float xy = 2 * n.x * n.y, xz = 2 * n.x * n.z, yz = 2 * n.y * n.z;
    for (int k = 0; k < 3; ++k) {
        const auto& f = m.firstMoment[k];
        const auto& s = m.second[k];
        for (int i = 0; i < kBlockCells; ++i) {
            const float total = s[0][i] + s[1][i] + s[2][i];
            const float first = n.x * f[0][i] + n.y * f[1][i] + n.z * f[2][i];
            const float second = xx * s[0][i] + yy * s[1][i] + zz * s[2][i] + xy * s[3][i] +
                                 xz * s[4][i] + yz * s[5][i];
            const float irradiance = constant[i] * total + linear[i] * first + square[i] * second;
            out.irradiance[k][i] = cut[i] ? irradiance : out.irradiance[k][i];
        }
    }
}

}  // namespace

void lightCells(const CellMoments& m, const Vec3f& n, const Rgb& weights, CellLight& out) {
    alignas(64) float height[kBlockCells], distance[kBlockCells];
    for (int i = 0; i < kBlockCells; ++i) {
        height[i] = n.x * m.axis[0][i] + n.y * m.axis[1][i] + n.z * m.axis[2][i];
        const float above = height[i] > 0 ? 1.0f : 0.0f;
        const float r = n.x * m.firstMoment[0][0][i] + n.y * m.firstMoment[0][1][i] +
                        n.z * m.firstMoment[0][2][i];
        const float g = n.x * m.firstMoment[1][0][i] + n.y * m.firstMoment[1][1][i] +
                        n.z * m.firstMoment[1][2][i];
        const float b = n.x * m.firstMoment[2][0][i] + n.y * m.firstMoment[2][1][i] +
                        n.z * m.firstMoment[2][2][i];
        out.irradiance[0][i] = above * r;
        out.irradiance[1][i] = above * g;
        out.irradiance[2][i] = above * b;
        out.light[i] = above * (weights.x * r + weights.y * g + weights.z * b);
        out.cosineMoment[i] = 1;
        out.fitMoment[i] = 1;
        distance[i] = std::abs(height[i]) - m.sinRadius[i];
    }
    out.anyHorizon = minimumOf(distance) < 0;
    if (out.anyHorizon) lightHorizon(m, n, height, out);
}

}  // namespace shadowcache
