#pragma once

#include <span>

#include "common/cache/transport.h"
#include "common/predict/bounce_solve.h"
#include "common/predict/places.h"
#include "common/trace/scene.h"

namespace shadowcache {

/// By which light bounces in a set. All of one cache.
struct BouncePaths {
    const ItemTable& items;
    const Transport& transport;
    std::span<const ItemLook> looks;  ///< by item
    int bounces;                      ///< surfaces that light may meet; below 0: any number
};

/// The irradiance of places as a linear function of the light of the sky's patches: what
/// irradianceAt() and irradianceInAir() predict is, under a sky of even patches, the sum over the
/// patches of the operator's entries times lightOfPatches(). The light of emitters is not in it.
struct SkyOperator {
    const ShadowCache& cache;
    const Scene* scene = nullptr;  ///< whose rays see for places in the air; null: none may be
    const BouncePaths* bounces = nullptr;  ///< null: direct light alone
    int level = 3;                         ///< of the patches

    /// @param out  for each place each patch in three colours [1]; NaN for those that are no places
    ///             (isPlace())
    /// @throws Error naming the first place in the air without a scene
    void rows(const Places& places, std::span<Rgb> out) const;
};

}  // namespace shadowcache
