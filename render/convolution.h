#pragma once

#include <vector>

#include "common/environment.h"
#include "render/triangulation.h"

namespace shadowcache {

/// Irradiance on a surface of unit normal `n` from the part of the map in a cell of level 0 ..
/// Environment::kLevel, as if nothing hid it: exact, but for texels that the horizon cuts, which
/// count by their middles.
Vec3d cellIrradiance(const Environment& environment, int level, std::uint32_t cell,
                     const Vec3d& n) noexcept;

/// The same from all of the map. [paper 3.1, eq. 2]
Vec3d mapIrradiance(const Environment& environment, const Vec3d& n) noexcept;

/// Its luminance over a triangle of any level: the diffuse convolution I_i(n). [paper 4.2]
double convolve(const Environment& environment, const MapTriangle& triangle,
                const Vec3d& n) noexcept;

/// Triangles' diffuse convolutions, tabulated over the normal. [paper 4.2]
class ConvolutionTable {
public:
    static constexpr std::size_t kPolar = 32, kAzimuth = 64;

    ConvolutionTable(const Environment& environment, const std::vector<MapTriangle>& triangles);

    /// I_i(n) of all triangles, bilinear between the table's normals.
    void evaluate(const Vec3f& n, std::vector<float>& out) const;

private:
    const float* row(std::size_t y, std::size_t x) const {
        return values_.data() + (y * kAzimuth + x) * count_;
    }

    std::size_t count_;
    std::vector<float> values_;
};

}  // namespace shadowcache
