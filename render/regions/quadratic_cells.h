#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/cache/cache_header.h"
#include "common/light/environment.h"

namespace shadowcache {

/// Sixteen cells over which functions of the direction are fitted by quadratics. With a cell's
/// corners a, b, c and w = l0 a + l1 b + l2 c, the quadratic is homogeneous in l; numbers of
/// products l_i l_j are in the order 00, 11, 22, 01, 12, 20.
struct alignas(64) QuadraticBlock {
    /// Corners, then the sides' midpoints 01, 12, 20: a quadratic is fixed by its values there.
    /// Then three places within, a corner each nearest, where the fit is judged.
    static constexpr int kNodes = 6, kPlaces = 9;
    float place[kPlaces][3][kBlockCells];  ///< [x, y, z]: unit vectors
    float side[3][kBlockCells];    ///< square of the sum of a side's corners: 1 / (l_i l_j) there
    float within[3][kBlockCells];  ///< square of l of the two farther corners at those places
    float moment[3][6][kBlockCells];  ///< [colour]: integral of L l_i l_j over the cell
                                      ///< [radiance sr]
};

/// A function of the direction with three colours, fitted in each of sixteen cells by the quadratic
/// through its values at the corners and the sides' midpoints.
struct alignas(64) QuadraticFit {
    float product[3][6][kBlockCells];  ///< [colour]: factors of l_i l_j
};

/// Values of a function at the places of sixteen cells.
using PlaceValues = float[QuadraticBlock::kPlaces][3][kBlockCells];

/// Cells of a cache's tiers, down to the finest that the environment tabulates. Immutable,
/// thread-safe.
class QuadraticCells {
public:
    QuadraticCells(const Environment& environment, const DirectionTiers& tiers);

    /// Finest level: Environment::kLevel, or one less where the tiers' levels are even.
    int finest() const { return finest_; }
    /// Cells 16 block .. 16 block + 15 of a level of the tiers' parity, at most finest().
    const QuadraticBlock& block(int level, std::uint32_t block) const {
        return blocks_[static_cast<std::size_t>(level)][block];
    }
    /// Value at the unit vector `w` in a cell of the fit that was made for it.
    Rgb value(const QuadraticFit& fit, int level, std::uint32_t cell, const Vec3f& w) const;

private:
    int finest_;
    std::array<std::vector<QuadraticBlock>, Environment::kLevel + 1> blocks_;
};

/// Fits the function with these values.
void fitQuadratic(const QuadraticBlock& cells, const PlaceValues& values, QuadraticFit& fit);

/// Makes the fit of one of the cells a constant.
void setConstant(const QuadraticBlock& cells, int cell, const Rgb& value, QuadraticFit& fit);

/// The fit at place kNodes + `number` of the cells, of one colour.
void fitWithin(const QuadraticBlock& cells, const QuadraticFit& fit, int number, int color,
               float (&values)[kBlockCells]);

/// Integral of the radiance times the fit over each cell, exact. [radiance sr]
void integrateQuadratic(const QuadraticBlock& cells, const QuadraticFit& fit,
                        float (&integral)[3][kBlockCells]);

}  // namespace shadowcache
