#include "render/cached/place_lookup.h"

#include <cmath>

namespace shadowcache {

namespace {

/// The counts do not include what moves.
void addOccluderCone(const Ball& ball, const SetPlace& place, PooledVisibility& pooled) {
    const Vec3f towards = ball.center - place.rayOrigin;
    const float distance = towards.length();
    if (distance > ball.radius)
        pooled.addOccluderCone(towards / distance, std::asin(ball.radius / distance));
    else
        pooled.addOccluderCone(place.geometricNormal, static_cast<float>(kPi));
}

}  // namespace

std::span<const ItemView> PlaceLookup::find(const SetPlace& place) {
    const int found = reader_.lookUp(place.position, place.geometricNormal, items_);
    return std::span(items_).first(static_cast<std::size_t>(found));
}

int PlaceLookup::pool(const Scene& scene, const SetPlace& place, float radius) {
    const std::span<const ItemView> found = find(place);
    pooled_.pool(found);
    for (const Ball& ball : scene.movingBalls())
        addOccluderCone({ball.center, ball.radius + radius}, place, pooled_);
    return static_cast<int>(found.size());
}

}  // namespace shadowcache
