#include "render/cell_light.h"

#include <cmath>

#include "render/horizon.h"
#include "render/lanes.h"

namespace shadowcache {

namespace {

void lightHorizonCell(const CellMoments& m, const Vec3f& n, float height, int i, CellLight& out) {
    const HorizonFit fit(height, m.sinRadius[i]);
    for (int k = 0; k < 3; ++k) {
        const float(*s)[kBlockCells] = m.second[k];
        const float total = s[0][i] + s[1][i] + s[2][i];
        const float first = n.x * m.flux[k][0][i] + n.y * m.flux[k][1][i] + n.z * m.flux[k][2][i];
        const float second = n.x * n.x * s[0][i] + n.y * n.y * s[1][i] + n.z * n.z * s[2][i] +
                             2 * (n.x * n.y * s[3][i] + n.x * n.z * s[4][i] + n.y * n.z * s[5][i]);
        out.flux[k][i] = fit.constant * total + fit.linear * first + fit.square * second;
    }
    out.light[i] = m.power[i];
    out.cosineMoment[i] = fit.cosineMoment;
    out.fitMoment[i] = fit.fitMoment;
}

}  // namespace

void lightCells(const CellMoments& m, const Vec3f& n, const Rgb& weights, CellLight& out) {
    alignas(64) float height[kBlockCells], distance[kBlockCells];
    for (int i = 0; i < kBlockCells; ++i) {
        height[i] = n.x * m.axis[0][i] + n.y * m.axis[1][i] + n.z * m.axis[2][i];
        const float above = height[i] > 0 ? 1.0f : 0.0f;
        const float r = n.x * m.flux[0][0][i] + n.y * m.flux[0][1][i] + n.z * m.flux[0][2][i];
        const float g = n.x * m.flux[1][0][i] + n.y * m.flux[1][1][i] + n.z * m.flux[1][2][i];
        const float b = n.x * m.flux[2][0][i] + n.y * m.flux[2][1][i] + n.z * m.flux[2][2][i];
        out.flux[0][i] = above * r;
        out.flux[1][i] = above * g;
        out.flux[2][i] = above * b;
        out.light[i] = above * (weights.x * r + weights.y * g + weights.z * b);
        out.cosineMoment[i] = 1;
        out.fitMoment[i] = 1;
        distance[i] = std::abs(height[i]) - m.sinRadius[i];
    }
    out.anyHorizon = minimumOf(distance) < 0;
    if (!out.anyHorizon) return;
    for (int i = 0; i < kBlockCells; ++i)
        if (std::abs(height[i]) < m.sinRadius[i]) lightHorizonCell(m, n, height[i], i, out);
}

}  // namespace shadowcache
