#pragma once

#include "common/mesh/looks.h"
#include "common/shot/view.h"

namespace shadowcache {

/// How light leaves the surface that was hit, towards the ray: before panes tint it.
///
/// @param plain  of what has no material and no vertex colours
Surface surfaceOf(const Hit& hit, const PlainLook& plain);

/// The same, as a camera's ray shows it through the panes on the way.
Surface surfaceSeen(const Hit& hit, const PlainLook& plain);

/// Where the rays start that look for the light of a place: off the surface, on the viewer's side,
/// and on the smooth surface that the facets stand for. Relative to the set's origin.
Vec3f rayStartOf(const Scene& scene, const View& view);

}  // namespace shadowcache
