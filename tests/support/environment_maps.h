#pragma once

#include <string>
#include <vector>

#include "common/light/environment.h"

namespace shadowcache::test {

// Maps that samplers are tried on, and the texels of an environment as a test sees them.

struct NamedMap {
    std::string name;
    Image map;
    double rotation = 0;  ///< degrees
};

/// Every map that has any light: real ones, hostile ones, one texel lit, a sun of 1e9, all equal.
/// Names alone, since each start of a test program asks for them and real maps take a while to
/// read.
std::vector<std::string> litMapNames();
/// One of them.
NamedMap litMap(const std::string& name);

/// Direction before a rotation of the map by `angle` [rad]: counter-clockwise seen from above takes
/// +Z to +X.
Vec3d unturned(const Vec3d& w, double angle);

/// The texels of an environment: their cells, and which one a direction meets.
class Texels {
public:
    Texels(const Environment& environment, double rotationDegrees);

    std::size_t size() const { return cellOf_.size(); }
    std::uint32_t cell(std::size_t i, int level) const {
        return ancestorCell(cellOf_[i], Environment::kLevel, level);
    }
    double solidAngle(std::size_t i) const;
    double luminanceIntegral(std::size_t i) const;
    /// Integral of the direction over a texel, exact.
    Vec3d moment(std::size_t i) const;
    std::size_t along(const Vec3f& direction) const { return rankOf_[place(direction)]; }

private:
    const Environment& environment_;
    double rotation_;
    int width_, height_;
    std::vector<std::uint32_t> cellOf_;
    std::vector<std::size_t> rankOf_;

    std::size_t place(const Vec3f& direction) const;
};

}  // namespace shadowcache::test
