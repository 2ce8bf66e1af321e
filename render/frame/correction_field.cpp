#include "render/frame/correction_field.h"

#include <algorithm>
#include <cmath>

#include "common/base/hash.h"
#include "common/base/tuned.h"

namespace shadowcache {

namespace {

/// Sides of the grids' cells, in those of the finest.
constexpr float kSides[] = {16, 4, 1};

/// Places that the next coarser grid counts as.
SHADOWCACHE_TUNED(float, kCoarserPlaces, 0.3f);

/// Calls `visit` with the key of each corner of the cell around a position, and its weight; weights
/// sum to 1.
template <class Visit>
void forEachCorner(const Vec3f& position, float side, const Visit& visit) {
    std::array<std::uint64_t, 3> first;
    std::array<float, 3> along;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        // Beyond what grids tell apart, all is one cell.
        const float at = std::clamp(position[static_cast<int>(axis)] / side, -0x1p62f, 0x1p62f);
        const float below = std::floor(at);
        first[axis] = static_cast<std::uint64_t>(static_cast<std::int64_t>(below));
        along[axis] = at - below;
    }
    for (unsigned corner = 0; corner < 8; ++corner) {
        float weight = 1;
        std::array<std::uint64_t, 3> key;
        for (unsigned axis = 0; axis < 3; ++axis) {
            const unsigned step = corner >> axis & 1;
            weight *= step != 0 ? along[axis] : 1 - along[axis];
            key[axis] = first[axis] + step;
        }
        if (weight > 0) visit(hashWords(key[0], key[1], key[2]), weight);
    }
}

/// Calls `visit` with each side of a cube that a unit normal shows, and its weight; weights sum
/// to 1.
template <class Visit>
void forEachSide(const Vec3f& normal, const Visit& visit) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const float along = normal[static_cast<int>(axis)];
        if (along != 0) visit(2 * axis + (along < 0 ? 1 : 0), along * along);
    }
}

}  // namespace

Rgb CheckedLight::correct(const Rgb& light) const {
    Rgb corrected;
    for (int k = 0; k < 3; ++k)
        corrected[k] = found[k] >= predicted[k]
                           ? light[k] + (found[k] - predicted[k])
                           : light[k] * (std::max(0.0f, found[k]) / predicted[k]);
    return corrected;
}

CheckedPlace& CheckedPlace::add(const CheckedPlace& other, float factor) {
    for (auto part : {&CheckedPlace::direct, &CheckedPlace::indirect}) {
        (this->*part).predicted += (other.*part).predicted * factor;
        (this->*part).found += (other.*part).found * factor;
    }
    return *this;
}

void CorrectionField::Sum::add(const Sum& other, float factor) {
    weight += other.weight * factor;
    light.add(other.light, factor);
}

CheckedPlace CorrectionField::Sum::mean() const {
    return weight > 0 ? CheckedPlace().add(light, 1 / weight) : CheckedPlace();
}

CorrectionField::CorrectionField(std::span<const Place> places, float finest) {
    for (const float side : kSides) grids_.push_back({side * finest, {}});
    Sum all;
    for (const Place& place : places) {
        const Sum one{1, place.light};
        all.add(one, 1);
        for (Grid& grid : grids_)
            forEachCorner(place.position, grid.side, [&](std::uint64_t key, float weight) {
                Corner& corner = grid.corners[key];
                forEachSide(place.normal, [&](std::size_t side, float share) {
                    corner[side].add(one, weight * share);
                });
            });
    }
    mean_ = all.mean();
}

CheckedPlace CorrectionField::at(const Vec3f& position, const Vec3f& normal) const {
    CheckedPlace found = mean_;
    for (const Grid& grid : grids_) {
        Sum sum;
        sum.add({1, found}, kCoarserPlaces);
        forEachCorner(position, grid.side, [&](std::uint64_t key, float weight) {
            const auto corner = grid.corners.find(key);
            if (corner == grid.corners.end()) return;
            forEachSide(normal, [&](std::size_t side, float share) {
                sum.add(corner->second[side], weight * share);
            });
        });
        found = sum.mean();
    }
    return found;
}

}  // namespace shadowcache
