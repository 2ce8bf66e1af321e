#include "render/frame/film.h"

#include <cmath>

namespace shadowcache {

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
        for (const Pixel& p : film.pixels) alpha.push_back(p.coverage);
    return alpha;
}

Image colorImage(const Film& film) {
    Image image{film.width, film.height, {}};
    image.pixels.reserve(film.pixels.size());
    for (const Pixel& p : film.pixels) image.pixels.push_back(p.color);
    return image;
}

}  // namespace shadowcache
