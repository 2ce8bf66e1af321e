#include "render/bounces/item_looks.h"

#include <array>

#include "common/base/parallel.h"
#include "render/estimators/set_place.h"

namespace shadowcache {

namespace {

/// How far above an item's mean point its ray starts, and how far below that it may find the
/// surface, in spacings.
constexpr double kAbove = 0.25, kReach = 1;

/// Calls visit(item, hit) for the surface of each item, in parallel; the hit is null where none is
/// near.
template <class Visit>
void forEachSurface(const Scene& scene, const ItemTable& items, const Visit& visit) {
    constexpr auto kSize = static_cast<std::size_t>(RayPacket::kSize);
    parallelFor(items.size(), 1024, [&](const Chunk& chunk) {
        RayPacket packet{};
        std::array<Hit, kSize> hits;
        for (std::size_t first = chunk.begin; first < chunk.end; first += kSize) {
            const std::size_t count = std::min(kSize, chunk.end - first);
            for (std::size_t i = 0; i < count; ++i) {
                const auto item = static_cast<std::uint32_t>(first + i);
                packet.set(static_cast<int>(i), aboveItem(scene, items, item), -items.normal(item));
            }
            scene.meetStill(packet, static_cast<int>(count), hits.data());
            for (std::size_t i = 0; i < count; ++i) {
                const bool near = hits[i].found &&
                                  static_cast<double>(hits[i].distance) < kReach * items.spacing();
                visit(first + i, near ? &hits[i] : nullptr);
            }
        }
    });
}

}  // namespace

Vec3f aboveItem(const Scene& scene, const ItemTable& items, std::uint32_t item) {
    const Vec3d above =
        items.position(item) + Vec3d(items.normal(item)) * (kAbove * items.spacing());
    return Vec3f(above - scene.mesh().origin);
}

ItemLook lookOf(const Hit& hit, const PlainLook& plain) {
    const Surface surface = surfaceOf(hit, plain);
    if (surface.unlit) return {Rgb(0, 0, 0), surface.emission};
    // Of all light that it reflects the share in each colour, about.
    return {surface.glossy ? surface.diffuse + surface.f0 * (Rgb(1, 1, 1) - surface.diffuse)
                           : surface.diffuse,
            surface.emission};
}

std::vector<ItemLook> looksOf(const Scene& scene, const ItemTable& items, const PlainLook& plain) {
    std::vector<ItemLook> looks(items.size());
    const ItemLook fallback{plain.albedo, Rgb(0, 0, 0)};
    forEachSurface(scene, items, [&](std::size_t item, const Hit* hit) {
        looks[item] = hit ? lookOf(*hit, plain) : fallback;
    });
    return looks;
}

std::vector<std::vector<Rgb>> emittedByGroup(const Scene& scene, const ItemTable& items,
                                             std::span<const ItemLook> looks,
                                             const LightGroups& groups) {
    std::vector<std::vector<Rgb>> emitted(groups.size());
    for (std::size_t g = LightGroups::kSky + 1; g < groups.size(); ++g)
        emitted[g].resize(items.size(), Rgb(0, 0, 0));
    forEachSurface(scene, items, [&](std::size_t item, const Hit* hit) {
        if (hit && looks[item].emission != Rgb(0, 0, 0))
            emitted[groups.ofHit(*hit)][item] = looks[item].emission;
    });
    return emitted;
}

}  // namespace shadowcache
