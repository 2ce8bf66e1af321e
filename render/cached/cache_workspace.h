#pragma once

#include "common/base/tuned.h"
#include "common/predict/cache_preview.h"
#include "common/predict/item_irradiance.h"
#include "render/cached/cosine_light.h"
#include "render/cached/lobe_light.h"
#include "render/cached/place_lookup.h"

namespace shadowcache {

/// Noise of a cell, as a share of the place's light, from which on it is split where a prediction
/// only decides how many camera rays pay: it is rough in any case, and many are made.
inline SHADOWCACHE_TUNED(float, kLeastSpreadShare, 0.2f);

/// Irradiance without rays.
struct IrradianceWithoutRays {
    IrradianceWithoutRays(const ShadowCache& cache, const Environment& environment,
                          float leastShare)
        : preview(environment, cache.header().tiers(), leastShare), byItem(preview) {}
    IrradianceWithoutRays(const IrradianceWithoutRays&) = delete;
    IrradianceWithoutRays& operator=(const IrradianceWithoutRays&) = delete;

    CachePreview preview;
    ItemIrradiance byItem;
};

/// What one thread of the estimator `cache` works with.
struct CacheWorkspace final : Workspace {
    CacheWorkspace(const ShadowCache& cache, const Environment& environment)
        : lookup(cache),
          preview(cache, environment, kLeastPreviewShare),
          rough(cache, environment, kLeastSpreadShare),
          cosines(environment, cache.header().tiers()),
          lobes(environment, cache.header().tiers()) {}

    PlaceLookup lookup;
    IrradianceWithoutRays preview, rough;
    LightTools<CosineIntegrand> cosines;
    LobeWorkspace lobes;
};

}  // namespace shadowcache
