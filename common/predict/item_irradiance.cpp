#include "common/predict/item_irradiance.h"

#include <optional>

#include "common/math/direction_mesh.h"

namespace shadowcache {

namespace {

/// Logarithm to the base 2 of the number of sums that are kept.
constexpr int kEntryBits = 14;

/// Square of the difference of two normals up to which the irradiance at one is extrapolated from
/// the other: 26 degrees. Beyond that the horizon cuts other cells.
constexpr float kMostTilt2 = 0.2f;

/// Square up to which normals count as equal: on flat surfaces no gradient is needed.
constexpr float kLeastTilt2 = 1e-6f;

/// Level of the direction cells whose centroids replace the item's normal beyond that.
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
        const std::uint64_t key = item.number * (2 + cellCount(kNormalLevel));
        const Vec3f tilt = normal - item.normal;
        const float tilt2 = tilt.length2();
        if (tilt2 <= kLeastTilt2) {
            sum += item.weight * flat(item, key);
        } else if (tilt2 <= kMostTilt2) {
            sum += item.weight * near(item, key + 1, item.normal).at(tilt);
        } else {
            if (!cell) cell = locateCell(kNormalLevel, Vec3d(normal));
            const Vec3f& middle = middles()[*cell];
            sum += item.weight * near(item, key + 2 + *cell, middle).at(normal - middle);
        }
    }
    return sum;
}

const Rgb& ItemIrradiance::flat(const ItemView& item, std::uint64_t key) {
    Entry& found = entry(key);
    if (found.key != key) {
        found.irradiance.value = preview_.irradiance(item, item.normal);
        found.key = key;
    }
    return found.irradiance.value;
}

const IrradianceWithGradient& ItemIrradiance::near(const ItemView& item, std::uint64_t key,
                                                   const Vec3f& normal) {
    Entry& found = entry(key);
    if (found.key != key) found = {key, preview_.irradianceWithGradient(item, normal)};
    return found.irradiance;
}

ItemIrradiance::Entry& ItemIrradiance::entry(std::uint64_t key) {
    if (entries_.empty()) entries_.resize(std::size_t{1} << kEntryBits);
    return entries_[key * 0x9e3779b97f4a7c15 >> (64 - kEntryBits)];
}

}  // namespace shadowcache
