#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "common/math/vec.h"

namespace shadowcache {

/// Light as it is predicted, and as rays found it.
struct CheckedLight {
    Rgb predicted{0, 0, 0}, found{0, 0, 0};

    /// What a prediction that is wrong as this one is becomes: what it lacks is added, and what is
    /// too much of it is a factor, so that nothing falls below 0.
    Rgb correct(const Rgb& light) const;
};

/// All irradiance of a place: by sources, and by other surfaces. [radiance sr]
struct CheckedPlace {
    CheckedLight direct, indirect;

    CheckedPlace& add(const CheckedPlace& other, float factor);
};

/// Checked light of some places as a smooth function of position and normal: their mean where they
/// are near each other, and where there are none the mean of all. It is kept in the corners of
/// grids of growing size, by the side of a cube that a normal shows [McTaggart 2004]; each grid
/// counts against the next coarser one by how many places it knows. Immutable, thread-safe.
class CorrectionField {
public:
    struct Place {
        Vec3f position;
        Vec3f normal;  ///< unit
        CheckedPlace light;
    };

    /// @param finest  side of the finest grid's cells [length], above 0
    CorrectionField(std::span<const Place> places, float finest);

    /// @param normal  unit
    CheckedPlace at(const Vec3f& position, const Vec3f& normal) const;

private:
    struct Sum {
        float weight = 0;
        CheckedPlace light;

        void add(const Sum& other, float factor);
        CheckedPlace mean() const;
    };
    /// Sums at a corner, by the side that a normal shows: + and - of x, y and z.
    using Corner = std::array<Sum, 6>;
    struct Grid {
        float side;
        std::unordered_map<std::uint64_t, Corner> corners;
    };

    std::vector<Grid> grids_;  ///< the coarsest first
    CheckedPlace mean_;
};

}  // namespace shadowcache
