#pragma once

#include <vector>

#include "common/light/environment.h"
#include "render/paper/triangulation.h"

namespace shadowcache {

/// Irradiance from the map on a surface of unit normal `n`, as if nothing occluded it: exact, but
/// for texels that the horizon cuts, which count by their middles. [paper 3.1, eq. 2]
Vec3d mapIrradiance(const Environment& environment, const Vec3d& n) noexcept;

/// That irradiance, tabulated over the normal, bilinear in polar angle and azimuth. The nodes are
/// exact, but for cells of level Environment::kLevel that the horizon cuts: HorizonFit stands for
/// the cosine there.
class IrradianceTable {
public:
    static constexpr std::size_t kPolar = 129, kAzimuth = 256;

    explicit IrradianceTable(const Environment& environment);

    Rgb evaluate(const Vec3f& n) const;

private:
    std::vector<Rgb> values_;
};

/// Luminance of the irradiance over a triangle of any level: the diffuse convolution I_i(n).
/// [paper 4.2]
double convolve(const Environment& environment, const MapTriangle& triangle,
                const Vec3d& n) noexcept;

/// Triangles' diffuse convolutions, tabulated over the normal, with nodes as IrradianceTable's.
/// [paper 4.2]
class ConvolutionTable {
public:
    static constexpr std::size_t kPolar = 32, kAzimuth = 64;

    ConvolutionTable(const Environment& environment, const std::vector<MapTriangle>& triangles);

    /// I_i(n) of all triangles, bilinear between the table's normals.
    void evaluate(const Vec3f& n, std::vector<float>& out) const;

private:
    std::size_t count_;
    std::vector<float> values_;
};

}  // namespace shadowcache
