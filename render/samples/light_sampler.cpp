#include "render/samples/light_sampler.h"

#include <array>
#include <cstddef>
#include <optional>
#include <span>

#include "common/light/environment.h"
#include "render/regions/cosine_integrand.h"
#include "render/regions/region_builder.h"
#include "render/regions/region_distribution.h"

namespace shadowcache {

struct LightSampler::Impl {
    const ShadowCache& cache;
    const std::optional<Environment> own;
    const Environment& environment;
    const CellSplitter splitter;
    const Calibration calibration{};  ///< of no pilot: the counts as they are

    Impl(const ShadowCache& source, const RadianceImage& map, double rotationDegrees)
        : cache(source),
          own(std::in_place, map.image, rotationDegrees, map.luminanceWeights),
          environment(*own),
          splitter(environment, source.header().tiers()) {}
    Impl(const ShadowCache& source, const Environment& given)
        : cache(source), environment(given), splitter(given, source.header().tiers()) {}
};

LightSampler::LightSampler(const ShadowCache& cache, const RadianceImage& map,
                           double rotationDegrees)
    : impl_(std::make_unique<Impl>(cache, map, rotationDegrees)) {}
LightSampler::LightSampler(const ShadowCache& cache, const Environment& environment)
    : impl_(std::make_unique<Impl>(cache, environment)) {}
LightSampler::~LightSampler() = default;

struct LightSampler::Reader::Impl {
    const LightSampler::Impl& sampler;
    ShadowCache::Reader reader;
    std::array<ItemView, ShadowCache::kMaxItems> items{};
    PooledVisibility pooled;
    RegionBuilder<CosineIntegrand> builder;
    RegionShares shares;
    RegionDistribution distribution;
    // Of the place.
    Vec3f normal{0, 1, 0};
    const FittedRegions<CosineIntegrand>* fitted = nullptr;
    Rgb integral{0, 0, 0};

    explicit Impl(const LightSampler::Impl& source)
        : sampler(source),
          reader(source.cache),
          pooled(source.cache.header().tiers()),
          builder(source.environment, source.cache.header().tiers()),
          distribution(source.environment) {}

    LightSample at(const EnvironmentSample& light, const RegionPlace& place, double pdf) const {
        LightSample sample{light.direction, light.radiance, Rgb(0.0f), pdf};
        if (place.found()) {
            const float visibility = shares.groups[place.group].visibility[place.lane];
            const float x = light.direction.dot(normal);
            sample.control =
                light.radiance * (visibility * fitted->fits[place.group].value(place.lane, x));
        }
        return sample;
    }
};

namespace {

/// As RegionSharer where no sample is reused at other places, however heavy it is.
void shareSamples(const Regions& regions, SampleAim aim, RegionShares& shares) {
    const RegionWeights ofDifference(regions, {});
    constexpr float kUnseen = static_cast<float>(kDefensiveShare);
    shares.groups.resize(regions.groups.size());
    shares.weightSum = 0;
    for (std::size_t g = 0; g < regions.groups.size(); ++g) {
        const RegionGroup& from = regions.groups[g];
        GroupShares& to = shares.groups[g];
        to = {};
        for (int i = 0; i < kBlockCells; ++i) {
            to.weight[i] = aim == SampleAim::difference
                               ? ofDifference.of(from, i)
                               : from.light[i] * (from.calibrated[i] + kUnseen);
            to.visibility[i] = from.visibility[i];
            to.weightSum += static_cast<double>(to.weight[i]);
        }
        shares.weightSum += to.weightSum;
    }
}

}  // namespace

LightSampler::Reader::Reader(const LightSampler& sampler)
    : impl_(std::make_unique<Impl>(*sampler.impl_)) {}
LightSampler::Reader::~Reader() = default;
LightSampler::Reader::Reader(Reader&&) noexcept = default;

bool LightSampler::Reader::moveTo(const Vec3d& position, const Vec3f& normal, SampleAim aim) {
    Impl& my = *impl_;
    const Environment& environment = my.sampler.environment;
    const int found = my.reader.lookUp(position, normal, my.items);
    my.pooled.pool(std::span(my.items).first(static_cast<std::size_t>(found)));
    my.normal = normal;
    my.fitted = &my.builder.build(CosineIntegrand(environment, my.sampler.splitter, normal, 0, 0),
                                  my.pooled, my.sampler.calibration);
    const Regions& regions = my.fitted->regions;
    shareSamples(regions, aim, my.shares);
    my.distribution.assign(regions, my.shares);
    my.integral = CosineIntegral(environment, *my.fitted, my.shares).at(normal);
    return found > 0;
}

bool LightSampler::Reader::empty() const {
    return impl_->distribution.empty();
}

const Rgb& LightSampler::Reader::integral() const {
    return impl_->integral;
}

LightSample LightSampler::Reader::sample(double u, float x, float y) const {
    const EnvironmentSample light = impl_->distribution.sample(u, x, y);
    return impl_->at(light, impl_->distribution.find(light.cell),
                     static_cast<double>(light.density));
}

LightSample LightSampler::Reader::along(const Vec3f& direction) const {
    const Environment& environment = impl_->sampler.environment;
    EnvironmentSample light = environment.lookUp(direction);
    light.direction = direction;
    const RegionPlace place = impl_->distribution.find(light.cell);
    const double density = static_cast<double>(light.density) * environment.luminanceIntegral();
    return impl_->at(light, place, impl_->distribution.pdf(place, density));
}

}  // namespace shadowcache
