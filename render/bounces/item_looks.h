#pragma once

#include <vector>

#include "common/mesh/looks.h"
#include "common/predict/bounce_solve.h"
#include "common/trace/scene.h"

namespace shadowcache {

/// How the surfaces of a cache's items look, each where a ray from above meets the item's mean
/// point; what reflects glossily counts as diffuse. Where none is met, the plain look.
std::vector<ItemLook> looksOf(const Scene& scene, const ItemTable& items, const PlainLook& plain);

}  // namespace shadowcache
