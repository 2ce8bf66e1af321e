#include "render/paper/convolution.h"

#include <algorithm>
#include <cmath>

#include "common/base/parallel.h"
#include "common/predict/horizon.h"

namespace shadowcache {

namespace {

/// Normal at a node of a table of polar angles, both poles among them, and azimuths.
Vec3d nodeNormal(std::size_t node, std::size_t polarCount, std::size_t azimuthCount) {
    const std::size_t row = node / azimuthCount, column = node % azimuthCount;
    const double polar = kPi * static_cast<double>(row) / static_cast<double>(polarCount - 1);
    const double azimuth =
        2 * kPi * static_cast<double>(column) / static_cast<double>(azimuthCount);
    return {std::sin(polar) * std::sin(azimuth), std::cos(polar),
            std::sin(polar) * std::cos(azimuth)};
}

/// The four nodes around a normal, and their weights.
struct Bilinear {
    std::size_t node[4];
    float weight[4];
};

Bilinear nodesAround(const Vec3f& n, std::size_t polarCount, std::size_t azimuthCount) {
    const double polar = std::acos(std::clamp(static_cast<double>(n.y), -1.0, 1.0));
    double azimuth = std::atan2(static_cast<double>(n.x), static_cast<double>(n.z)) / (2 * kPi);
    azimuth -= std::floor(azimuth);
    const double y = polar / kPi * static_cast<double>(polarCount - 1),
                 x = azimuth * static_cast<double>(azimuthCount);
    const std::size_t y0 = std::min(static_cast<std::size_t>(y), polarCount - 2);
    const std::size_t x0 = static_cast<std::size_t>(x) % azimuthCount, x1 = (x0 + 1) % azimuthCount;
    const auto fy = static_cast<float>(y - static_cast<double>(y0)),
               fx = static_cast<float>(x - std::floor(x));
    return {{y0 * azimuthCount + x0, y0 * azimuthCount + x1, (y0 + 1) * azimuthCount + x0,
             (y0 + 1) * azimuthCount + x1},
            {(1 - fy) * (1 - fx), (1 - fy) * fx, fy * (1 - fx), fy * fx}};
}

/// Texel by texel; those below the horizon add nothing.
Vec3d texelIrradiance(const Environment& environment, std::uint32_t cell, const Vec3d& n) {
    Vec3d sum(0, 0, 0);
    environment.forEachTexel(cell, [&](std::uint32_t i) {
        const Environment::Texel texel = environment.texel(i);
        const double cosine = n.dot(Vec3d(texel.center));
        if (cosine > 0)
            sum += Vec3d(texel.radiance) * (cosine * static_cast<double>(texel.solidAngle));
    });
    return sum;
}

/// From moments alone: a quadratic stands for the cosine.
Vec3d fittedIrradiance(const Environment& environment, std::uint32_t cell, const Vec3d& n) {
    const CellMoments& m = environment.cells(Environment::kLevel, cell / CellMoments::kSize);
    const std::uint32_t k = cell % CellMoments::kSize;
    const Vec3f axis(m.axis[0][k], m.axis[1][k], m.axis[2][k]), normal(n);
    const HorizonFit fit(normal.dot(axis), m.sinRadius[k]);
    Vec3d sum(0, 0, 0);
    for (int c = 0; c < 3; ++c) {
        const auto& s = m.second[c];
        const Vec3f firstMoment(m.firstMoment[c][0][k], m.firstMoment[c][1][k],
                                m.firstMoment[c][2][k]);
        const Vec3f turned(s[0][k] * normal.x + s[3][k] * normal.y + s[4][k] * normal.z,
                           s[3][k] * normal.x + s[1][k] * normal.y + s[5][k] * normal.z,
                           s[4][k] * normal.x + s[5][k] * normal.y + s[2][k] * normal.z);
        const float value = fit.constant * (s[0][k] + s[1][k] + s[2][k]) +
                            fit.linear * normal.dot(firstMoment) + fit.square * normal.dot(turned);
        sum[c] = std::max(0.0, static_cast<double>(value));
    }
    return sum;
}

/// Irradiance from a cell; `cut` decides about cells of the finest level on the horizon.
template <typename Cut>
Vec3d sumCells(const Environment& environment, int level, std::uint32_t cell, const Vec3d& n,
               const Cut& cut) {
    const CellMoments& m = environment.cells(level, cell / CellMoments::kSize);
    const std::uint32_t k = cell % CellMoments::kSize;
    const double height = n.dot(Vec3d(Vec3f(m.axis[0][k], m.axis[1][k], m.axis[2][k])));
    const auto sine = static_cast<double>(m.sinRadius[k]);
    Vec3d sum(0, 0, 0);
    if (height <= -sine || m.luminanceIntegral[k] <= 0) return sum;
    if (height >= sine) {
        for (int c = 0; c < 3; ++c)
            sum[c] = std::max(0.0, n.dot(Vec3d(Vec3f(m.firstMoment[c][0][k], m.firstMoment[c][1][k],
                                                     m.firstMoment[c][2][k]))));
        return sum;
    }
    if (level == Environment::kLevel) return cut(environment, cell, n);
    for (std::uint32_t child = 4 * cell; child < 4 * cell + 4; ++child)
        sum += sumCells(environment, level + 1, child, n, cut);
    return sum;
}

/// Irradiance from all of the map; `cut` as in sumCells.
template <typename Cut>
Vec3d sumMap(const Environment& environment, const Vec3d& n, const Cut& cut) {
    Vec3d sum(0, 0, 0);
    for (std::uint32_t cell = 0; cell < cellCount(0); ++cell)
        sum += sumCells(environment, 0, cell, n, cut);
    return sum;
}

/// Diffuse convolution of a triangle; `cut` as in sumCells.
template <typename Cut>
double convolveBy(const Environment& environment, const MapTriangle& t, const Vec3d& n,
                  const Cut& cut) {
    const double height = n.dot(t.axis), sine = t.sinRadius;
    if (height >= sine) return std::max(0.0, n.dot(t.firstMoment));
    if (height <= -sine) return 0;
    if (t.level <= Environment::kLevel)
        return sumCells(environment, t.level, t.cell, n, cut)
            .dot(Vec3d(environment.luminanceWeights()));
    // Finer than the order of the texels: one cosine for all of the triangle.
    return t.luminanceIntegral * std::max(height, sine / 4);
}

}  // namespace

Vec3d mapIrradiance(const Environment& environment, const Vec3d& n) noexcept {
    return sumMap(environment, n, texelIrradiance);
}

IrradianceTable::IrradianceTable(const Environment& environment) : values_(kPolar * kAzimuth) {
    parallelFor(values_.size(), 64, [&](const Chunk& chunk) {
        for (std::size_t node = chunk.begin; node < chunk.end; ++node) {
            const Vec3d n = nodeNormal(node, kPolar, kAzimuth);
            values_[node] = Rgb(sumMap(environment, n, fittedIrradiance));
        }
    });
}

Rgb IrradianceTable::evaluate(const Vec3f& n) const {
    const Bilinear around = nodesAround(n, kPolar, kAzimuth);
    Rgb sum(0, 0, 0);
    for (int k = 0; k < 4; ++k) sum += values_[around.node[k]] * around.weight[k];
    return sum;
}

double convolve(const Environment& environment, const MapTriangle& t, const Vec3d& n) noexcept {
    return convolveBy(environment, t, n, texelIrradiance);
}

ConvolutionTable::ConvolutionTable(const Environment& environment,
                                   const std::vector<MapTriangle>& triangles)
    : count_(triangles.size()), values_(count_ * kPolar * kAzimuth) {
    parallelFor(kPolar * kAzimuth, 8, [&](const Chunk& chunk) {
        for (std::size_t node = chunk.begin; node < chunk.end; ++node)
            for (std::size_t i = 0; i < count_; ++i)
                values_[node * count_ + i] = static_cast<float>(
                    convolveBy(environment, triangles[i], nodeNormal(node, kPolar, kAzimuth),
                               fittedIrradiance));
    });
}

void ConvolutionTable::evaluate(const Vec3f& n, std::vector<float>& out) const {
    const Bilinear around = nodesAround(n, kPolar, kAzimuth);
    const float* rows[4];
    for (int k = 0; k < 4; ++k) rows[k] = values_.data() + around.node[k] * count_;
    out.resize(count_);
    for (std::size_t i = 0; i < count_; ++i)
        out[i] = around.weight[0] * rows[0][i] + around.weight[1] * rows[1][i] +
                 around.weight[2] * rows[2][i] + around.weight[3] * rows[3][i];
}

}  // namespace shadowcache
