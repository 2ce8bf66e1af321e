#pragma once

#include <span>
#include <vector>

#include "common/predict/bounce_solve.h"

namespace shadowcache {

/// What a solve predicts of the light that bounces, that of each light group apart. The solve is
/// linear in the light: the groups' add up to the whole. Immutable, thread-safe.
class GroupedSolve {
public:
    /// @param whole      of all light; outlives this object
    /// @param transport  that it was solved with
    /// @param looks      likewise, by item
    /// @param lights     of each group: what it adds to E^0 before the exposure, by item. The first
    ///                   group's stay empty: it has what the others leave of the whole
    /// @param firstShines  whether it has any
    GroupedSolve(const BounceSolve& whole, const Transport& transport,
                 std::span<const ItemLook> looks, std::span<const std::vector<Rgb>> lights,
                 bool firstShines);

    /// What bounces add to the irradiance of an item, by group. [radiance sr]
    void indirect(std::uint32_t item, int bounces, std::span<Rgb> light) const;
    /// The same at a place, by the items of a lookup there.
    void indirect(std::span<const ItemView> items, int bounces, std::span<Rgb> light) const;

    std::size_t memoryBytes() const;

private:
    template <class Where>
    void indirectOf(const Where& where, int bounces, std::span<Rgb> light) const;

    const BounceSolve& whole_;
    std::vector<BounceSolve> others_;  ///< of the groups but the first
    const bool firstShines_;
};

}  // namespace shadowcache
