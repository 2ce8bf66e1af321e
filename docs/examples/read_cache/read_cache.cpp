// Asks a cache how open the sky is at a place of the set: read_cache set.vdb X Y Z NX NY NZ
#include <array>
#include <cstdio>
#include <cstdlib>
#include <exception>

#include "common/cache/shadow_cache.h"

int main(int argc, char** argv) try {
    using namespace shadowcache;
    if (argc != 8) {
        std::fprintf(stderr, "usage: read_cache set.vdb X Y Z NX NY NZ\n");
        return 2;
    }
    const auto number = [&](int i) { return std::atof(argv[i]); };
    const Vec3d position(number(2), number(3), number(4));
    const Vec3f normal(Vec3d(number(5), number(6), number(7)).normalized());

    const ShadowCache cache(argv[1]);
    const DirectionTiers tiers = cache.header().tiers();
    std::printf("%zu items, spacing %g\n", cache.itemCount(), cache.header().spacing);

    // A reader is one thread's; the items' weights sum to 1.
    ShadowCache::Reader reader(cache);
    std::array<ItemView, ShadowCache::kMaxItems> items;
    const int found = reader.lookUp(position, normal, items);

    // Item by item n of d rays reached the sky in each region; here only the coarsest regions, by
    // their cosine. Finer counts stand in the items' blocks (docs/format.md).
    double open = 0, all = 0;
    for (std::uint32_t cell = 0; cell < tiers.baseCells(); ++cell) {
        const double cosine = cellCenter(tiers.baseLevel(), cell).dot(Vec3d(normal));
        for (int i = 0; i < found && cosine > 0; ++i) {
            const ItemView& item = items[static_cast<std::size_t>(i)];
            if (item.d[cell] == 0) continue;
            open += cosine * static_cast<double>(item.weight) * item.n[cell] / item.d[cell];
            all += cosine * static_cast<double>(item.weight);
        }
    }
    std::printf("%d items here, open to the sky: %.0f %%\n", found, all > 0 ? 100 * open / all : 0);
} catch (const std::exception& e) {
    std::fprintf(stderr, "read_cache: %s\n", e.what());
    return 1;
}
