#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/emitters/emitter_part.h"

namespace shadowcache {

/// Where a triangle with a picture emits: its cells, of a texel or less, by what they emit. Half
/// of the points that it draws are of cells in proportion to that, half are samplePoint()'s of the
/// whole triangle, which are better where it is near. Immutable.
class EmissionTable {
public:
    /// Looks at a triangle.
    ///
    /// @param most   that any point may emit [luminance of radiance]
    /// @param cells  at most so many; each takes 16 bytes and a quarter of a microsecond
    /// @return none where the picture has next to no texels on the triangle
    static std::optional<EmissionTable> of(const TriangleMesh& mesh, std::uint32_t triangle,
                                           float most, std::size_t cells);

    /// Radiance in the mean over the triangle.
    const Rgb& mean() const { return mean_; }
    /// Luminance that a cell may emit at least, in the mean over the cells: what points between
    /// those that were looked at may have.
    float floor() const { return floor_; }
    /// Whether points by cells pay: even ones have at least twice their second moment.
    bool pays() const;

    /// samplePoint() of a triangle, by this table.
    EmitterPoint sample(const EmitterPart& triangle, const Receiver& at, double u,
                        double v) const noexcept;
    /// Density with which sample() draws a point [1/sr].
    float densityAt(const EmitterPart& triangle, const Receiver& at,
                    const Vec3f& position) const noexcept;

private:
    /// One of the triangles into which lines along the sides divide a triangle: `across` and `up`
    /// along its first and second side; of the two in a parallelogram the lower one, which has the
    /// triangle's position, or the upper one, which is turned by half a circle.
    struct Cell {
        std::size_t across, up;
        bool upper;
    };

    explicit EmissionTable(std::size_t side) : side_(side), sums_(2 * side * side) {}

    std::size_t numberOf(const Cell& cell) const {
        return 2 * (cell.up * side_ + cell.across) + (cell.upper ? 1 : 0);
    }
    Cell cellOf(std::size_t number) const {
        return {number / 2 % side_, number / 2 / side_, number % 2 != 0};
    }
    Cell cellAt(double u, double v) const noexcept;
    double chanceOf(std::size_t number) const noexcept;
    EmitterPart partOf(const EmitterPart& triangle, const Cell& cell) const noexcept;
    float densityOf(const EmitterPart& triangle, const Receiver& at, const Cell& cell,
                    const Vec3f& position) const noexcept;

    std::size_t side_;          ///< cells along each side
    std::vector<double> sums_;  ///< of what cells emit, up to each; beyond the third side it stays
    Rgb mean_{0, 0, 0};
    double square_ = 0;  ///< mean over the cells of what they emit, squared
    float floor_ = 0;
};

}  // namespace shadowcache
