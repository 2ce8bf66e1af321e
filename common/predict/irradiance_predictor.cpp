#include "common/predict/irradiance_predictor.h"

#include <array>
#include <span>

#include "common/light/environment.h"
#include "common/predict/cache_preview.h"
#include "common/predict/item_irradiance.h"

namespace shadowcache {

struct IrradiancePredictor::Impl {
    const ShadowCache& cache;
    Environment environment;
    CachePreview preview;

    Impl(const ShadowCache& source, const RadianceImage& map, double rotationDegrees)
        : cache(source),
          environment(map.image, rotationDegrees, map.luminanceWeights),
          preview(environment, source.header().tiers()) {}
};

IrradiancePredictor::IrradiancePredictor(const ShadowCache& cache, const RadianceImage& map,
                                         double rotationDegrees)
    : impl_(std::make_unique<Impl>(cache, map, rotationDegrees)) {}
IrradiancePredictor::~IrradiancePredictor() = default;

struct IrradiancePredictor::Reader::Impl {
    ShadowCache::Reader reader;
    ItemIrradiance irradiance;
    std::array<ItemView, ShadowCache::kMaxItems> items{};

    explicit Impl(const IrradiancePredictor::Impl& predictor)
        : reader(predictor.cache), irradiance(predictor.preview) {}
};

IrradiancePredictor::Reader::Reader(const IrradiancePredictor& predictor)
    : impl_(std::make_unique<Impl>(*predictor.impl_)) {}
IrradiancePredictor::Reader::~Reader() = default;
IrradiancePredictor::Reader::Reader(Reader&&) noexcept = default;

std::optional<Rgb> IrradiancePredictor::Reader::irradiance(const Vec3d& position,
                                                           const Vec3f& normal) {
    const int found = impl_->reader.lookUp(position, normal, impl_->items);
    if (found == 0) return {};
    return impl_->irradiance.mean(std::span(impl_->items).first(static_cast<std::size_t>(found)),
                                  normal);
}

}  // namespace shadowcache
