#include "common/cache/transport.h"

#include <algorithm>

#include "common/base/interrupt.h"
#include "common/base/parallel.h"
#include "common/cache/hit_code.h"
#include "common/cache/open_cache.h"

namespace shadowcache {

namespace {

constexpr std::size_t kItemsAtOnce = 1024;

std::uint32_t resolve(std::uint16_t code, const Vec3d& from, const Vec3f& direction,
                      const ItemTable& items) {
    if (code == HitCode::kSky) return kSky;
    if (!HitCode::isFree(code)) return kNoItem;
    return items.itemOfSide(from + Vec3d(direction) * HitCode::distance(code), HitCode::side(code));
}

}  // namespace

std::optional<Transport> readTransport(const ShadowCache& cache, const ItemTable& items) {
    const int rays = cache.header().hits;
    if (rays == 0) return std::nullopt;
    std::vector<std::uint16_t> codes;
    codes.reserve(items.size() * static_cast<std::size_t>(rays));
    OpenCache::visitLeaves(cache, true, [&](const Vec3i&, const LeafView& leaf) {
        throwIfInterrupted();
        codes.insert(codes.end(), leaf.hits,
                     leaf.hits + std::size_t{leaf.items} * leaf.hitsPerItem);
    });
    Transport transport{rays, std::vector<std::uint32_t>(codes.size())};
    parallelFor(items.size(), kItemsAtOnce, [&](const Chunk& chunk) {
        throwIfInterrupted();
        for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
            const ItemTable::Item& item = items.item(static_cast<std::uint32_t>(i));
            const HitRays ways(item.voxel, item.patch, item.normal, rays);
            const Vec3d from = Vec3d(item.voxel) + Vec3d(item.position);
            for (int k = 0; k < rays; ++k) {
                const std::size_t at =
                    i * static_cast<std::size_t>(rays) + static_cast<std::size_t>(k);
                transport.hit[at] = resolve(codes[at], from, ways.direction(k), items);
            }
        }
    });
    return transport;
}

std::vector<std::uint16_t> readEmitterCodes(const ShadowCache& cache) {
    std::vector<std::uint16_t> codes;
    if (cache.header().emitters.empty()) return codes;
    OpenCache::visitLeaves(cache, true, [&](const Vec3i&, const LeafView& leaf) {
        throwIfInterrupted();
        codes.insert(codes.end(), leaf.emitters,
                     leaf.emitters + std::size_t{leaf.items} * leaf.emittersPerItem);
    });
    return codes;
}

}  // namespace shadowcache
