#include "common/predict/many_places.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "common/base/parallel.h"
#include "common/predict/cached_visibility.h"
#include "common/predict/item_irradiance.h"

namespace shadowcache {

namespace {

/// Places of a thread at a time: enough for what it keeps to pay.
constexpr std::size_t kPlaceChunk = 8192;

constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();

/// Spreads the lower 21 bits, two zeros between any two.
std::uint64_t spreadBits(std::uint64_t bits) {
    bits &= 0x1fffff;
    bits = (bits | bits << 32) & 0x1f00000000ffff;
    bits = (bits | bits << 16) & 0x1f0000ff0000ff;
    bits = (bits | bits << 8) & 0x100f00f00f00f00f;
    bits = (bits | bits << 4) & 0x10c30c30c30c30c3;
    return (bits | bits << 2) & 0x1249249249249249;
}

/// Along a curve through the voxels that seldom jumps. [Morton 1966]
std::uint64_t placeOnCurve(const Vec3d& position, double spacing) {
    std::uint64_t place = 0;
    for (int axis = 0; axis < 3; ++axis) {
        // Beyond 2^31 there are no items, and the order does not matter.
        const double voxel = std::clamp(std::floor(position[axis] / spacing), -0x1p31, 0x1p31);
        place |= spreadBits(static_cast<std::uint64_t>(static_cast<std::int64_t>(voxel))) << axis;
    }
    return place;
}

/// Numbers of the places that can find anything, near ones together.
std::vector<std::uint64_t> orderOf(const Places& places, double spacing) {
    std::vector<std::pair<std::uint64_t, std::uint64_t>> keys;
    keys.reserve(places.size());
    for (std::size_t i = 0; i < places.size(); ++i)
        if (isPlace(places, i)) keys.emplace_back(placeOnCurve(places.positions[i], spacing), i);
    std::ranges::sort(keys);
    std::vector<std::uint64_t> order;
    order.reserve(keys.size());
    for (const auto& [key, number] : keys) order.push_back(number);
    return order;
}

/// The items of one place after the other.
class ItemsAround {
public:
    ItemsAround(const ShadowCache& cache, const Places& places) : reader_(cache), places_(places) {}

    /// Looks place i up, unless it is the one before. Returns whether the items are others now.
    bool moveTo(std::size_t i) {
        const Vec3d& position = places_.positions[i];
        const Vec3d& normal = places_.normals[i];
        if (known_ && position == position_ && normal == wanted_) return false;
        known_ = true;
        position_ = position;
        wanted_ = normal;
        normal_ = Vec3f(unitAlong(normal));
        found_ = static_cast<std::size_t>(reader_.lookUp(position, normal_, items_));
        return true;
    }
    std::span<const ItemView> items() const { return std::span(items_).first(found_); }
    const Vec3f& normal() const { return normal_; }

private:
    ShadowCache::Reader reader_;
    const Places& places_;
    bool known_ = false;
    Vec3d position_{0.0}, wanted_{0.0};
    Vec3f normal_{0.0f};
    std::array<ItemView, ShadowCache::kMaxItems> items_{};
    std::size_t found_ = 0;
};

/// @param adjust  makes of a place's number, its items, and the direct irradiance there what is
///                wanted
template <class Adjust>
void irradianceOfAll(const ShadowCache& cache, const CachePreview& preview, const Places& places,
                     std::span<Rgb> out, const Adjust& adjust) {
    std::ranges::fill(out, Rgb(kNothing));
    const std::vector<std::uint64_t> order = orderOf(places, cache.header().spacing);
    parallelFor(order.size(), kPlaceChunk, [&](const Chunk& chunk) {
        ItemsAround around(cache, places);
        ItemIrradiance irradiance(preview);
        for (std::size_t k = chunk.begin; k < chunk.end; ++k) {
            around.moveTo(order[k]);
            if (!around.items().empty())
                out[order[k]] = adjust(order[k], around.items(),
                                       irradiance.mean(around.items(), around.normal()));
        }
    });
}

}  // namespace

void irradianceAt(const ShadowCache& cache, const CachePreview& preview, const Places& places,
                  std::span<Rgb> out) {
    irradianceOfAll(
        cache, preview, places, out,
        [](std::size_t, std::span<const ItemView>, const Rgb& direct) { return direct; });
}

void irradianceAt(const ShadowCache& cache, const CachePreview& preview, const BounceSolve& solve,
                  int bounces, const Places& places, std::span<Rgb> out,
                  std::span<const Rgb> more) {
    irradianceOfAll(cache, preview, places, out,
                    [&](std::size_t i, std::span<const ItemView> items, const Rgb& sky) {
                        const Rgb direct = more.empty() ? sky : sky + more[i];
                        return direct * (1 / solve.exposure(items)) +
                               solve.indirect(items, bounces);
                    });
}

void visibilityAt(const ShadowCache& cache, const Places& places, std::span<const Vec3d> directions,
                  std::span<float> out) {
    std::ranges::fill(out, kNothing);
    const std::vector<std::uint64_t> order = orderOf(places, cache.header().spacing);
    parallelFor(order.size(), kPlaceChunk, [&](const Chunk& chunk) {
        ItemsAround around(cache, places);
        PooledVisibility pooled(cache.header().tiers());
        for (std::size_t k = chunk.begin; k < chunk.end; ++k) {
            if (around.moveTo(order[k])) pooled.pool(around.items());
            const Vec3d& direction = directions[order[k]];
            if (around.items().empty() || !isDirection(direction)) continue;
            out[order[k]] = visibilityAlong(pooled, unitAlong(direction)).ratio;
        }
    });
}

}  // namespace shadowcache
