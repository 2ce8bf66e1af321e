#pragma once

#include <span>
#include <vector>

#include "common/mesh/looks.h"
#include "common/predict/bounce_solve.h"
#include "common/trace/scene.h"
#include "render/estimators/light_groups.h"

namespace shadowcache {

/// A place above the surface of an item, on its lit side, relative to the set's origin: its mean
/// point lies off a curved surface.
Vec3f aboveItem(const Scene& scene, const ItemTable& items, std::uint32_t item);

/// How the surface that a ray met looks; what reflects glossily counts as diffuse.
ItemLook lookOf(const Hit& hit, const PlainLook& plain);

/// How the surfaces of a cache's items look, each where a ray from above meets the item's mean
/// point. Where none is met, the plain look.
std::vector<ItemLook> looksOf(const Scene& scene, const ItemTable& items, const PlainLook& plain);

/// What the surfaces of items emit, by light group: [group][item]; empty for the sky's.
///
/// @param looks  of looksOf(), by the same
std::vector<std::vector<Rgb>> emittedByGroup(const Scene& scene, const ItemTable& items,
                                             std::span<const ItemLook> looks,
                                             const LightGroups& groups);

}  // namespace shadowcache
