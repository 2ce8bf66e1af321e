#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "common/light/environment_map.h"
#include "common/math/direction_mesh.h"
#include "common/math/turn.h"

namespace shadowcache {

/// Direction drawn from an environment.
struct EnvironmentSample {
    Vec3f direction;          ///< unit, world space
    Rgb radiance;             ///< along it
    float density;            ///< [1/sr] with respect to the region that was sampled
    std::uint32_t cell = 0;   ///< of level Environment::kLevel, that the texel belongs to
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

/// Distant light from a lat-long map, turned and tinted: radiance constant over each texel. Every
/// grain of the map belongs to the cell that holds its centre, so the integrals over cells are
/// exact sums over texels. World space: +Y is up. Unturned, longitude 0 (image centre) is +Z, +pi/2
/// is +X. Thread-safe while it is not turned.
class Environment {
public:
    /// Finest level of the direction mesh whose cells are tabulated.
    static constexpr int kLevel = 5;

    /// @param map   shared by all the environments that turn it
    /// @param gain  the map's radiance is multiplied by it; finite, 0 or more
    explicit Environment(std::shared_ptr<const EnvironmentMap> map, const Turn& turn = {},
                         const Rgb& gain = Rgb(1.0f));

    /// A map for this environment alone.
    ///
    /// @param map              as of EnvironmentMap
    /// @param rotationDegrees  turns the map about +Y, counter-clockwise seen from above
    /// @throws Error as EnvironmentMap
    Environment(const Image& map, double rotationDegrees, const Rgb& luminanceWeights);

    /// Turns the map anew: some 10 ms, whatever the number of texels (docs/numerics.md). Nobody may
    /// use the environment meanwhile, and tables made of it hold no longer.
    void turn(const Turn& turn, const Rgb& gain);

    /// Luminance of the three primaries; their sum is 1.
    const Rgb& luminanceWeights() const { return map_->luminanceWeights(); }
    /// Luminance of linear RGB.
    float luminance(const Rgb& c) const { return luminanceWeights().dot(c); }

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

    /// Direction in cell `index` of `level` (whose luminance integral is positive); the density is
    /// with respect to that cell. It is proportional to the luminance, within a grain to that of
    /// the map without its tint.
    ///
    /// @param u                 chooses the texel, in [0, 1)
    /// @param jitterX, jitterY  choose the place in it, in [0, 1)
    EnvironmentSample sampleCell(int level, std::uint32_t index, double u, float jitterX,
                                 float jitterY) const noexcept;

    /// State of a draw in four steps, each of which reads memory that the one before prefetched:
    /// with many draws, one step at a time, the waits overlap. sampleCell() is all of them at once.
    struct Draw {
        double place;        ///< in the light of the cell, then of the grain, in 2^-32
        std::uint32_t cell;  ///< of level kLevel
        std::uint32_t grain;
        std::uint32_t texel;  ///< its index
        float share;          ///< of the cell, then of the grain, in the light of the region
    };
    /// Step 1: chooses the cell of level kLevel. Arguments as of sampleCell().
    Draw startDraw(int level, std::uint32_t index, double u) const noexcept;
    /// Step 2: chooses the grain.
    void findGrain(Draw& draw) const noexcept;
    /// Step 3: chooses the texel.
    void findTexel(Draw& draw) const noexcept;
    /// Step 4: chooses the place in the texel.
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
    std::size_t texelCount() const { return map_->texelCount(); }
    /// Unit direction to place (x, y) in [0, 1]^2 of texel i < texelCount(); uniform places are
    /// uniform in solid angle.
    Vec3d placeIn(std::size_t i, double x, double y) const noexcept;
    /// Texel i < texelCount(); near ones have near numbers.
    Texel texel(std::size_t i) const noexcept;
    /// Calls `visit` with the number i of every texel of a cell of level kLevel.
    template <class Visit>
    void forEachTexel(std::uint32_t cell, const Visit& visit) const {
        for (std::uint32_t k = firstGrain_[cell]; k < firstGrain_[cell + 1]; ++k) {
            const auto [first, end] = map_->texelsOf(grains_[k]);
            for (std::uint32_t i = first; i < end; ++i) visit(i);
        }
    }
    /// Upper bound of the luminance over the directions within `angle` [rad] of the unit vector
    /// `axis`.
    float maxLuminance(const Vec3d& axis, double angle) const noexcept;

private:
    struct IntegralTurn;
    struct Sums;
    void sortGrains();
    void sumCells();
    void sumCell(std::uint32_t cell, const IntegralTurn& turn, std::vector<double>& light,
                 Sums& sums);
    void tabulate(int level, std::uint32_t cell, const Sums& sums);
    void accumulate();
    Draw startDraw(std::uint32_t first, std::uint32_t last, double u) const noexcept;

    Vec3f toWorld(const Vec3f& w) const { return axis_[0] * w.x + axis_[1] * w.y + axis_[2] * w.z; }
    Vec3f toMap(const Vec3f& w) const {
        return {axis_[0].dot(w), axis_[1].dot(w), axis_[2].dot(w)};
    }

    std::shared_ptr<const EnvironmentMap> map_;
    Turn turn_;
    std::array<Vec3f, 3> axis_;  ///< as turn_
    Rgb gain_;
    double sphereLuminance_ = 0;
    /// A grain's cell, and its share in the light of the cell.
    struct GrainPlace {
        float share;
        std::uint32_t cell;
    };
    std::vector<GrainPlace> placeOf_;        ///< by grain
    std::vector<std::uint32_t> grains_;      ///< by cell
    std::vector<std::uint32_t> firstGrain_;  ///< per cell of kLevel, and the end
    std::vector<std::uint32_t> grainBegin_;  ///< of each of grains_: steps in the light of the cell
    std::vector<double> cellCdf_;            ///< over the cells of kLevel, cellCount + 1
    std::vector<float> cellShare_;           ///< in all light
    std::vector<std::uint32_t> guide_;       ///< where in cellCdf_ to begin
    std::array<std::vector<double>, kLevel + 1> luminance_;
    std::array<std::vector<CellMoments>, kLevel + 1> moments_;
};

}  // namespace shadowcache
