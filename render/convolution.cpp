#include "render/convolution.h"

#include <algorithm>
#include <cmath>

#include "common/parallel.h"

namespace shadowcache {

namespace {

Vec3d nodeNormal(std::size_t node) {
    const std::size_t row = node / ConvolutionTable::kAzimuth,
                      column = node % ConvolutionTable::kAzimuth;
    const double polar = kPi * static_cast<double>(row) / (ConvolutionTable::kPolar - 1);
    const double azimuth = 2 * kPi * static_cast<double>(column) / ConvolutionTable::kAzimuth;
    return {std::sin(polar) * std::sin(azimuth), std::cos(polar),
            std::sin(polar) * std::cos(azimuth)};
}

/// Texel by texel; those below the horizon add nothing.
Vec3d texelIrradiance(const Environment& environment, std::uint32_t cell, const Vec3d& n) {
    Vec3d sum(0, 0, 0);
    const auto [begin, end] = environment.texelsOf(cell);
    for (std::uint32_t i = begin; i < end; ++i) {
        const Environment::Texel texel = environment.texel(i);
        const double cosine = n.dot(Vec3d(texel.center));
        if (cosine > 0)
            sum += Vec3d(texel.radiance) * (cosine * static_cast<double>(texel.solidAngle));
    }
    return sum;
}

}  // namespace

Vec3d cellIrradiance(const Environment& environment, int level, std::uint32_t cell,
                     const Vec3d& n) noexcept {
    const CellMoments& m = environment.cells(level, cell / CellMoments::kSize);
    const std::uint32_t k = cell % CellMoments::kSize;
    const double height = n.dot(Vec3d(Vec3f(m.axis[0][k], m.axis[1][k], m.axis[2][k])));
    const auto sine = static_cast<double>(m.sinRadius[k]);
    Vec3d sum(0, 0, 0);
    if (height <= -sine || m.power[k] <= 0) return sum;
    if (height >= sine) {
        for (int c = 0; c < 3; ++c)
            sum[c] = std::max(
                0.0, n.dot(Vec3d(Vec3f(m.flux[c][0][k], m.flux[c][1][k], m.flux[c][2][k]))));
        return sum;
    }
    if (level == Environment::kLevel) return texelIrradiance(environment, cell, n);
    for (std::uint32_t child = 4 * cell; child < 4 * cell + 4; ++child)
        sum += cellIrradiance(environment, level + 1, child, n);
    return sum;
}

Vec3d mapIrradiance(const Environment& environment, const Vec3d& n) noexcept {
    Vec3d sum(0, 0, 0);
    for (std::uint32_t cell = 0; cell < cellCount(0); ++cell)
        sum += cellIrradiance(environment, 0, cell, n);
    return sum;
}

double convolve(const Environment& environment, const MapTriangle& t, const Vec3d& n) noexcept {
    const double height = n.dot(t.axis), sine = t.sinRadius;
    if (height >= sine) return std::max(0.0, n.dot(t.flux));
    if (height <= -sine) return 0;
    if (t.level <= Environment::kLevel)
        return cellIrradiance(environment, t.level, t.cell, n)
            .dot(Vec3d(environment.luminanceWeights()));
    // Finer than the order of the texels: one cosine for all of the triangle.
    return t.power * std::max(height, sine / 4);
}

ConvolutionTable::ConvolutionTable(const Environment& environment,
                                   const std::vector<MapTriangle>& triangles)
    : count_(triangles.size()), values_(count_ * kPolar * kAzimuth) {
    parallelFor(kPolar * kAzimuth, 8, [&](const Chunk& chunk) {
        for (std::size_t node = chunk.begin; node < chunk.end; ++node)
            for (std::size_t i = 0; i < count_; ++i)
                values_[node * count_ + i] =
                    static_cast<float>(convolve(environment, triangles[i], nodeNormal(node)));
    });
}

void ConvolutionTable::evaluate(const Vec3f& n, std::vector<float>& out) const {
    const double polar = std::acos(std::clamp(static_cast<double>(n.y), -1.0, 1.0));
    double azimuth = std::atan2(static_cast<double>(n.x), static_cast<double>(n.z)) / (2 * kPi);
    azimuth -= std::floor(azimuth);
    const double y = polar / kPi * (kPolar - 1), x = azimuth * kAzimuth;
    const std::size_t y0 = std::min(static_cast<std::size_t>(y), kPolar - 2);
    const std::size_t x0 = static_cast<std::size_t>(x) % kAzimuth, x1 = (x0 + 1) % kAzimuth;
    const auto fy = static_cast<float>(y - static_cast<double>(y0)),
               fx = static_cast<float>(x - std::floor(x));
    const float* a = row(y0, x0);
    const float* b = row(y0, x1);
    const float* c = row(y0 + 1, x0);
    const float* d = row(y0 + 1, x1);
    out.resize(count_);
    for (std::size_t i = 0; i < count_; ++i)
        out[i] = (1 - fy) * ((1 - fx) * a[i] + fx * b[i]) + fy * ((1 - fx) * c[i] + fx * d[i]);
}

}  // namespace shadowcache
