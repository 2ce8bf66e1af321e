#pragma once

#include "render/frame/frame_request.h"
#include "render/frame/pixel_sum.h"
#include "render/frame/ray_batch.h"

namespace shadowcache {

/// The place of a frame's set that a camera ray met.
SetPlace placeOf(const Scene& scene, const View& view);

/// What a pixel shows of the sky where a camera ray met nothing.
Rgb skySeen(const FrameRequest& frame, const View& view);

/// What it shows of lamps that cameras see, in front of what it met.
///
/// @param byGroup  receives the same by light group; empty: it is not asked for
Rgb lampsSeen(const FrameRequest& frame, const FilmRay& ray, std::span<Rgb> byGroup = {});

/// What it shows of all that shines by itself.
///
/// @param ofSurface  radiance that the surface emits that it met
/// @param byGroup    as of lampsSeen()
SeenEmission emissionSeen(const FrameRequest& frame, const FilmRay& ray, const Rgb& ofSurface,
                          std::span<Rgb> byGroup = {});

/// Irradiance by which a surface of such an albedo has a radiance.
float irradianceScale(const Environment& environment, double radiance, const Rgb& albedo);

/// The places that a batch's rays met.
MetPlaces placesOf(const FrameRequest& frame, const BatchPixels& batch,
                   std::span<const FilmRay> rays);

/// Estimates their direct light.
///
/// @param watched  pixel of the batch whose samples are noted; may be none
DirectLight lightDirectly(const FrameRequest& frame, const BatchPixels& batch, const MetPlaces& met,
                          std::optional<std::uint32_t> watched, Workspace& workspace);

/// Adds the places to which light bounces.
void addReceivers(const MetPlaces& met, std::vector<BounceReceiver>& receivers);

}  // namespace shadowcache
