#include "render/item_irradiance.h"

#include <optional>

#include "common/direction_mesh.h"

namespace shadowcache {

namespace {

/// Sums that are kept are 2 to the power of this.
constexpr int kEntryBits = 14;

/// Square of the difference of two normals up to which the irradiance at one is taken from its
/// gradient at the other: 26 degrees. Farther away the horizon is another one.
constexpr float kMostTilt2 = 0.2f;

/// Of the direction cells whose middles stand for normals farther from the item's.
constexpr int kNormalLevel = 2;

/// Unit vectors at the middles of those cells.
const std::vector<Vec3f>& middles() {
    static const std::vector<Vec3f> kMiddles = [] {
        std::vector<Vec3f> all;
        for (std::uint32_t cell = 0; cell < cellCount(kNormalLevel); ++cell)
            all.emplace_back(cellCenter(kNormalLevel, cell));
        return all;
    }();
    return kMiddles;
}

}  // namespace

Rgb ItemIrradiance::mean(std::span<const ItemView> items, const Vec3f& normal) {
    Rgb sum(0, 0, 0);
    std::optional<std::uint32_t> cell;
    for (const ItemView& item : items) {
        const std::uint64_t key = item.number * (1 + cellCount(kNormalLevel));
        const Vec3f tilt = normal - item.normal;
        if (tilt.length2() <= kMostTilt2) {
            sum += item.weight * near(item, key, item.normal).at(tilt);
            continue;
        }
        if (!cell) cell = locateCell(kNormalLevel, Vec3d(normal));
        const Vec3f& middle = middles()[*cell];
        sum += item.weight * near(item, key + 1 + *cell, middle).at(normal - middle);
    }
    return sum;
}

const IrradianceNear& ItemIrradiance::near(const ItemView& item, std::uint64_t key,
                                           const Vec3f& normal) {
    if (entries_.empty()) entries_.resize(std::size_t{1} << kEntryBits);
    Entry& entry = entries_[key * 0x9e3779b97f4a7c15 >> (64 - kEntryBits)];
    if (entry.key != key) entry = {key, preview_.irradianceNear(item, normal)};
    return entry.irradiance;
}

}  // namespace shadowcache
