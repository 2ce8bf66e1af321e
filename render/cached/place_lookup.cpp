#include "render/cached/place_lookup.h"

#include <cmath>

namespace shadowcache {

namespace {

/// The counts do not include what moves.
void addOccluderCone(const Ball& ball, const ShadingPoint& point, PooledVisibility& pooled) {
    const Vec3f towards = ball.center - point.rayOrigin;
    const float distance = towards.length();
    if (distance > ball.radius)
        pooled.addOccluderCone(towards / distance, std::asin(ball.radius / distance));
    else
        pooled.addOccluderCone(point.geometricNormal, static_cast<float>(kPi));
}

}  // namespace

std::span<const ItemView> PlaceLookup::find(const ShadingPoint& point) {
    const int found = reader_.lookUp(point.position, point.geometricNormal, items_);
    return std::span(items_).first(static_cast<std::size_t>(found));
}

int PlaceLookup::pool(const Scene& scene, const ShadingPoint& point, float radius) {
    const std::span<const ItemView> found = find(point);
    pooled_.pool(found);
    for (const Ball& ball : scene.movingBalls())
        addOccluderCone({ball.center, ball.radius + radius}, point, pooled_);
    return static_cast<int>(found.size());
}

}  // namespace shadowcache
