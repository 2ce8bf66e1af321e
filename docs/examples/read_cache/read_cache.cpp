// Prints what a cache predicts at a place of the set:
//   read_cache set.vdb X Y Z NX NY NZ [sky.exr]
#include <array>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <optional>
#include <span>

#include "common/cache/shadow_cache.h"
#include "common/image/radiance.h"
#include "common/math/direction_mesh.h"
#include "common/predict/cached_visibility.h"
#include "common/predict/irradiance_predictor.h"
#include "common/predict/pooled_visibility.h"

using namespace shadowcache;

namespace {

/// Visible share of the sky above a place, weighted by the cosine: that of a constant sky's light.
double skyVisibility(const PooledVisibility& pooled, const Vec3f& normal) {
    constexpr int kLevel = 3;
    double visible = 0, all = 0;
    for (std::uint32_t cell = 0; cell < cellCount(kLevel); ++cell) {
        const double cosine = cellCenter(kLevel, cell).dot(Vec3d(normal));
        if (cosine <= 0) continue;
        const double weight = cosine * solidAngle(cellTriangle(kLevel, cell));
        const CachedVisibility v = visibilityOf(pooled, kLevel, cell);
        if (v.rays > 0) visible += weight * static_cast<double>(v.ratio);
        if (v.rays > 0) all += weight;
    }
    return all > 0 ? visible / all : 0;
}

}  // namespace

int main(int argc, char** argv) try {
    if (argc != 8 && argc != 9) {
        std::fprintf(stderr, "usage: read_cache set.vdb X Y Z NX NY NZ [sky.exr]\n");
        return 2;
    }
    const auto number = [&](int i) { return std::atof(argv[i]); };
    const Vec3d position(number(2), number(3), number(4));
    const Vec3f normal(Vec3d(number(5), number(6), number(7)).normalized());

    const ShadowCache cache(argv[1]);
    std::printf("%zu items, spacing %g\n", cache.itemCount(), cache.header().spacing);

    // Counts: a reader belongs to one thread, and so do the pooled counts.
    ShadowCache::Reader reader(cache);
    std::array<ItemView, ShadowCache::kMaxItems> items;
    const int found = reader.lookUp(position, normal, items);
    PooledVisibility pooled(cache.header().tiers());
    pooled.pool(std::span(items).first(static_cast<std::size_t>(found)));
    std::printf("%d items here, sky visibility %.0f %%\n", found,
                100 * skyVisibility(pooled, normal));
    if (argc == 8) return 0;

    // Light: one predictor for all threads, one of its readers each.
    const IrradiancePredictor predictor(cache, readRadiance(argv[8]));
    IrradiancePredictor::Reader light(predictor);
    if (const std::optional<Rgb> irradiance = light.irradiance(position, normal))
        std::printf("irradiance %.3f %.3f %.3f\n", static_cast<double>(irradiance->x),
                    static_cast<double>(irradiance->y), static_cast<double>(irradiance->z));
    else
        std::printf("no irradiance: the cache has nothing here\n");
} catch (const std::exception& e) {
    std::fprintf(stderr, "read_cache: %s\n", e.what());
    return 1;
}
