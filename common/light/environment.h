#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "common/image/image.h"
#include "common/math/direction_mesh.h"

namespace shadowcache {

/// Direction drawn from an environment.
struct EnvironmentSample {
    Vec3f direction;          ///< unit, world space
    Rgb radiance;             ///< along it
    float density;            ///< [1/sr] with respect to the region that was sampled
    std::uint32_t cell = 0;   ///< of level Environment::kLevel, that holds the texel
    std::uint32_t texel = 0;  ///< Texel::index
};

/// Moments of the light in sixteen consecutive cells of a level (at level 2 and finer, those with a
/// common ancestor two levels up), as structure of arrays. Cells past the end of levels 0 and 1
/// have no light.
struct alignas(64) CellMoments {
    static constexpr int kSize = 16;  ///< cells
    float axis[3][kSize];             ///< [x, y, z]: unit vector at the cell's centroid
    float sinRadius[kSize];           ///< sine of the angle around it that holds the cell's texels
    float firstMoment[3][3][kSize];   ///< [colour][x, y, z]: integral of L(w) w over the cell
                                      ///< [radiance sr]
    float luminanceIntegral[kSize];   ///< integral of the luminance over the cell [radiance sr]
    /// [colour][xx, yy, zz, xy, xz, yz]: integral of L(w) w w^T over the cell [radiance sr]
    float second[3][6][kSize];
};

/// Distant light from a lat-long map: radiance constant over each texel. Every texel belongs to the
/// cell that holds its centre, so the integrals over cells are exact sums over texels. World space:
/// +Y is up, longitude 0 (image centre) is +Z, +pi/2 is +X. Immutable, thread-safe.
class Environment {
public:
    /// Finest level of the direction mesh whose cells are tabulated.
    static constexpr int kLevel = 5;

    /// @param map              width, height >= 1, finite and non-negative
    /// @param rotationDegrees  turns the map about +Y, counter-clockwise seen from above
    /// @param luminanceWeights sum to 1
    /// @throws Error for an empty map or one of over 2^31 texels
    Environment(const Image& map, double rotationDegrees, const Rgb& luminanceWeights);

    /// Luminance of the three primaries; their sum is 1.
    const Rgb& luminanceWeights() const { return luminanceWeights_; }
    /// Luminance of linear RGB.
    float luminance(const Rgb& c) const {
        return luminanceWeights_.x * c.x + luminanceWeights_.y * c.y + luminanceWeights_.z * c.z;
    }

    /// Integral of the luminance over the sphere [radiance sr].
    double luminanceIntegral() const { return sphereLuminance_; }

    /// Radiance along a unit direction.
    Rgb radiance(const Vec3f& direction) const noexcept;

    /// Moments of the cells 16 block .. 16 block + 15 of `level` (0 .. kLevel).
    const CellMoments& cells(int level, std::uint32_t block) const noexcept {
        return moments_[static_cast<std::size_t>(level)][block];
    }

    /// Integral of the luminance over a cell, level 0 .. kLevel [radiance sr].
    double luminanceIntegral(int level, std::uint32_t cell) const noexcept;

    /// Direction in cell `index` of `level` (whose luminance integral is positive) with density
    /// proportional to the luminance; the density is with respect to that cell.
    ///
    /// @param u                 chooses the texel, in [0, 1)
    /// @param jitterX, jitterY  choose the place in it, in [0, 1)
    EnvironmentSample sampleCell(int level, std::uint32_t index, double u, float jitterX,
                                 float jitterY) const noexcept;

    /// State of a draw in three steps, each of which reads memory that the one before prefetched:
    /// with many draws, one step at a time, the waits overlap. sampleCell() is all three at once.
    struct Draw {
        std::uint32_t cell;  ///< of level kLevel
        std::uint32_t step;  ///< place in the cell's light, in 2^-32
        std::uint32_t texel;
        float cellShare;  ///< of the cell in the light of the region
    };
    /// Step 1: chooses the cell of level kLevel. Arguments as of sampleCell().
    Draw startDraw(int level, std::uint32_t index, double u) const noexcept;
    /// Step 2: chooses the texel.
    void findTexel(Draw& draw) const noexcept;
    /// Step 3: chooses the place in the texel.
    EnvironmentSample finishDraw(const Draw& draw, float jitterX, float jitterY) const noexcept;

    /// As sampleCell, over the whole sphere (whose luminance integral is positive).
    EnvironmentSample sample(double u, float jitterX, float jitterY) const noexcept;

    /// Radiance along a unit direction, and the density with which sample() draws it [1/sr].
    EnvironmentSample lookUp(const Vec3f& direction) const noexcept;

    /// A texel, for integrals over other shapes than cells.
    struct Texel {
        Vec3f center;         ///< unit vector
        Rgb radiance;         ///< the same all over it
        float solidAngle;     ///< [sr]
        std::uint32_t index;  ///< place in the map, below texelCount()
    };
    /// Texels of the map, replicated if it is small.
    std::size_t texelCount() const { return sorted_.size(); }
    /// Unit direction to place (x, y) in [0, 1]^2 of texel i < texelCount(); uniform places are
    /// uniform in solid angle.
    Vec3d placeIn(std::size_t i, double x, double y) const noexcept;
    /// Texel i < texelCount(), in the order of the cells of level kLevel.
    Texel texel(std::size_t i) const noexcept;
    /// First texel of a cell of level kLevel, and the one behind its last.
    std::array<std::uint32_t, 2> texelsOf(std::uint32_t cell) const noexcept {
        return {firstTexel_[cell], firstTexel_[cell + 1]};
    }
    /// Upper bound of the luminance over the directions within `angle` [rad] of the unit vector
    /// `axis`.
    float maxLuminance(const Vec3d& axis, double angle) const noexcept;

private:
    std::size_t texelAlong(const Vec3f& direction) const noexcept;
    void sortTexels();
    void sumCells();
    void tabulate();
    void tabulateDensity();
    /// Share of its cell's light that the texel at place `rank` of sorted_ owns.
    double texelShare(std::uint32_t rank, std::uint32_t cellEnd) const noexcept;
    void accumulate(std::size_t cell, const std::vector<double>& weights);
    Draw startDraw(std::uint32_t first, std::uint32_t last, double u) const noexcept;

    std::size_t width_ = 0, height_ = 0;
    double rotation_ = 0;
    Rgb luminanceWeights_;
    double sphereLuminance_ = 0;
    /// Texel of the map, perhaps replicated, at y * width + x.
    struct MapTexel {
        Rgb radiance;
        float density;  ///< of sample() [1/sr]
    };
    struct SortedTexel {
        Rgb radiance;
        std::uint32_t index;  ///< y * width + x
    };
    std::vector<MapTexel> map_;
    std::vector<SortedTexel> sorted_;  ///< by cell
    /// Of each of sorted_: the light of the cell's texels before it, in 2^-32 of the cell. Apart,
    /// because drawing a texel searches it.
    std::vector<std::uint32_t> texelBegin_;
    std::vector<std::uint32_t> firstTexel_;  ///< per cell of kLevel, and the end
    std::vector<double> cellCdf_;            ///< over the cells of kLevel, cellCount + 1
    std::vector<std::uint32_t> guide_;       ///< where in cellCdf_ to begin
    std::vector<float> rowCos_, columnCos_, columnSin_;  ///< at texel borders
    std::array<std::vector<double>, kLevel + 1> luminance_;
    /// What is summed over a cell for each colour.
    struct Moments {
        // Imath leaves the numbers of a vector undefined unless set.
        std::array<Vec3d, 3> firstMoment{Vec3d(0.0), Vec3d(0.0), Vec3d(0.0)};
        std::array<std::array<double, 6>, 3> second{};
    };
    std::array<std::vector<Moments>, kLevel + 1> sums_;
    std::array<std::vector<CellMoments>, kLevel + 1> moments_;
};

}  // namespace shadowcache
