#include "bake/inspect/sky_view.h"

#include <array>
#include <cmath>
#include <span>

#include "common/math/direction_mesh.h"

namespace shadowcache {

namespace {

// Linear colours of the picture.
const Rgb kOccluded(0.008f, 0.008f, 0.012f);
const Rgb kMixed(0.85f, 0.36f, 0.04f);
const Rgb kVisible(0.35f, 0.66f, 1.0f);
const Rgb kBelow(0.11f, 0.11f, 0.11f);
const Rgb kUnknown(0.16f, 0.04f, 0.24f);

Rgb colorOf(double visible) {
    const auto between = [](const Rgb& a, const Rgb& b, double t) {
        return a * static_cast<float>(1 - t) + b * static_cast<float>(t);
    };
    return visible < 0.5 ? between(kOccluded, kMixed, 2 * visible)
                         : between(kMixed, kVisible, 2 * visible - 1);
}

}  // namespace

SkyView::SkyView(const ShadowCache& cache, const Vec3d& position, const Vec3f& normal)
    : normal_(normal) {
    ShadowCache::Reader reader(cache);
    std::array<ItemView, ShadowCache::kMaxItems> found;
    const int count = reader.lookUp(position, normal, found);
    for (const ItemView& item : std::span(found).first(static_cast<std::size_t>(count))) {
        items_.emplace_back(cache.header().tiers());
        items_.back().use(item);
        weights_.push_back(item.weight);
    }
}

SkyView::Sight SkyView::lookAtCell(std::uint32_t finestCell) const {
    Sight sight{0, 0};
    for (std::size_t i = 0; i < items_.size(); ++i) {
        const CountedRegion region = items_[i].along(finestCell);
        if (region.d == 0) continue;
        const auto weight = static_cast<double>(weights_[i]);
        sight.visible += weight * region.share();
        sight.counted += weight;
    }
    if (sight.counted > 0) sight.visible /= sight.counted;
    return sight;
}

SkyView::Sight SkyView::look(const Vec3d& direction) const {
    return lookAtCell(locateCell(kMaxCacheLevel, direction));
}

SkyView::Figures SkyView::figures() const {
    Figures f;
    double all = 0, knownCosine = 0;
    for (std::uint32_t cell = 0; cell < cellCount(kMaxCacheLevel); ++cell) {
        const Vec3d center = cellCenter(kMaxCacheLevel, cell);
        const double cosine = center.dot(normal_);
        if (cosine <= 0) continue;
        const double area = solidAngle(cellTriangle(kMaxCacheLevel, cell));
        all += area;
        const Sight sight = lookAtCell(cell);
        if (sight.counted <= 0) continue;
        f.known += area;
        knownCosine += area * cosine;
        f.visible += area * sight.visible;
        f.visibleCosine += area * cosine * sight.visible;
        f.bentNormal += center * (area * sight.visible);
        if (sight.visible <= 0 || sight.visible >= 1) f.pure += area;
    }
    if (f.known > 0) {
        f.visible /= f.known;
        f.visibleCosine /= knownCosine;
        f.pure /= f.known;
        f.known /= all;
    }
    if (f.bentNormal.length() > 0) f.bentNormal.normalize();
    return f;
}

Image SkyView::picture(int width) const {
    Image image{width, width / 2, {}};
    image.pixels.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(width / 2));
    for (int y = 0; y < image.height; ++y) {
        const double latitude = kPi * (0.5 - (y + 0.5) / image.height);
        for (int x = 0; x < width; ++x) {
            const double longitude = kPi * (1 - 2 * (x + 0.5) / width);
            const Vec3d direction(std::sin(longitude) * std::cos(latitude), std::sin(latitude),
                                  std::cos(longitude) * std::cos(latitude));
            if (direction.dot(normal_) <= 0) {
                image.pixels.push_back(kBelow);
                continue;
            }
            const Sight sight = look(direction);
            image.pixels.push_back(sight.counted > 0 ? colorOf(sight.visible) : kUnknown);
        }
    }
    return image;
}

}  // namespace shadowcache
