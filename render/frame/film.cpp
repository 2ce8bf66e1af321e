#include "render/frame/film.h"

#include <cmath>

namespace shadowcache {

namespace {

/// Calls visit(a's, b's) for each value of two camera rays that is no light, nor a share of it.
template <class Other, class Visit>
void forGeometry(RayValues& a, Other& b, const Visit& visit) {
    visit(a.roughness, b.roughness);
    visit(a.normal, b.normal);
    visit(a.position, b.position);
    visit(a.depth, b.depth);
    visit(a.axialDepth, b.axialDepth);
    visit(a.coverage, b.coverage);
    visit(a.openness, b.openness);
    visit(a.items, b.items);
    visit(a.regions, b.regions);
    visit(a.misses, b.misses);
}

/// Calls visit(a's, b's) for each value of two camera rays.
template <class Other, class Visit>
void forEachValue(RayValues& a, Other& b, const Visit& visit) {
    visit(a.color, b.color);
    visit(a.diffuse, b.diffuse);
    visit(a.glossy, b.glossy);
    visit(a.diffuseIndirect, b.diffuseIndirect);
    visit(a.glossyIndirect, b.glossyIndirect);
    visit(a.emission, b.emission);
    visit(a.environment, b.environment);
    visit(a.predicted, b.predicted);
    visit(a.irradiance, b.irradiance);
    visit(a.albedo, b.albedo);
    visit(a.diffuseAlbedo, b.diffuseAlbedo);
    visit(a.mirrorColor, b.mirrorColor);
    visit(a.alpha, b.alpha);
    forGeometry(a, b, visit);
}

}  // namespace

RayValues& RayValues::operator+=(const RayValues& other) {
    forEachValue(*this, other, [](auto& own, const auto& added) { own += added; });
    return *this;
}

RayValues& RayValues::operator*=(float factor) {
    forEachValue(*this, *this, [factor](auto& own, const auto&) { own *= factor; });
    return *this;
}

void RayValues::scaleGeometry(float factor) {
    forGeometry(*this, *this, [factor](auto& own, const auto&) { own *= factor; });
}

bool isFinite(const Pixel& p) {
    const Rgb all = p.color + p.irradiance;
    return std::isfinite(all.x) && std::isfinite(all.y) && std::isfinite(all.z) &&
           std::isfinite(p.variance);
}

double meanCameraRays(const Film& film) {
    double sum = 0;
    for (const Pixel& p : film.pixels) sum += static_cast<double>(p.cameraRays);
    return sum / static_cast<double>(film.pixels.size());
}

std::vector<float> alphaOf(const Film& film) {
    std::vector<float> alpha;
    if (film.transparent)
        for (const Pixel& p : film.pixels) alpha.push_back(p.alpha);
    return alpha;
}

Image colorImage(const Film& film) {
    Image image{film.width, film.height, {}};
    image.pixels.reserve(film.pixels.size());
    for (const Pixel& p : film.pixels) image.pixels.push_back(p.color);
    return image;
}

}  // namespace shadowcache
