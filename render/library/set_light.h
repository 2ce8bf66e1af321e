#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/cache/item_table.h"
#include "render/estimators/emitter_light.h"
#include "render/table/estimator_table.h"

namespace shadowcache {

/// What shines in a set: its emitters, and what a cache knows of where they are seen from.
class SetLight {
public:
    /// @param scene, cache  outlive it; `cache` may be null
    /// @return null if nothing shines
    static std::unique_ptr<SetLight> of(const Scene& scene, const ShadowCache* cache);

    const EmitterLight& light() const { return *light_; }
    const Emitters& emitters() const { return emitters_; }
    /// Whether the cache counts each emitter as it stands in the set, but for lamps that move.
    bool knowsAll() const { return knowsAll_; }
    /// What the cache does not count, as the end of a sentence about it: names the first emitter
    /// that was moved or added. Empty: knowsAll(), or there is no cache.
    std::string unknownText() const;
    /// Whether the cache counts none at all, not even some that stand elsewhere now.
    bool countsNone() const;
    /// Whether lamps move, which no cache counts.
    bool moves() const { return !emitters_.empty() && emitters_.moves(emitters_.size() - 1); }

    /// Learns where lamps that move stand now. What is known of the others stays.
    void moveLamps();

    /// Irradiance of each item by its own counts, without lamps that move; empty if some other
    /// emitter is not counted.
    std::vector<Rgb> predictItems(const ItemTable& items) const;
    /// The same of each light group, [group][item]; empty for the sky's.
    std::vector<std::vector<Rgb>> predictItems(const ItemTable& items,
                                               const LightGroups& groups) const;

private:
    SetLight(const Scene& scene, const ShadowCache* cache, Emitters emitters);
    void readCounts(const ShadowCache& cache);
    Receiver placeOf(const ItemTable& items, std::size_t item) const;
    /// Items to whose middle emitters send much more than to the mean one's.
    std::vector<bool> brightItems(const ItemTable& items) const;
    /// Calls visit(item, places that stand for it, tools of the thread) for each item, in parallel:
    /// its middle, or places all over it where light is bright and so changes.
    template <class Visit>
    void forEachItem(const ItemTable& items, const Visit& visit) const;

    const Scene& scene_;
    const ShadowCache* cache_;
    Emitters emitters_;
    bool knowsAll_ = false;
    std::vector<std::size_t> unknown_;             ///< emitters that the cache does not count
    std::optional<EmitterVisibility> visibility_;  ///< of the emitters that do not move
    std::optional<EmitterLight> light_;
};

/// @throws Error: the estimator does not include the light of emitters
[[noreturn]] void refuseEmitters(const EstimatorEntry& estimator, const SetLight& light);

}  // namespace shadowcache
