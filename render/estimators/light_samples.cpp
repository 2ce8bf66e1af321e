#include "render/estimators/light_samples.h"

namespace shadowcache {

void LightSamples::clear() {
    direction_.clear();
    ifVisible_.clear();
    ifOccluded_.clear();
    groupEnds_.clear();
}

void LightSamples::add(const Vec3f& direction, const Rgb& ifVisible, const Rgb& ifOccluded) {
    direction_.push_back(direction);
    ifVisible_.push_back(ifVisible);
    ifOccluded_.push_back(ifOccluded);
}

void LightSamples::trace(const Scene& scene, const SetPlace& place, const Environment& environment,
                         Estimate& estimate) {
    visible_.assign(size(), 0);
    RayPacket packet{};
    std::size_t sampleOf[RayPacket::kSize];
    int queued = 0;
    const auto flush = [&] {
        const std::uint32_t visible = scene.visibility(packet, queued);
        for (int i = 0; i < queued; ++i) {
            const std::size_t sample = sampleOf[i];
            visible_[sample] = (visible >> i) & 1;
            if (visible_[sample] && scene.tints())
                ifVisible_[sample] = tinted(ifVisible_[sample], ifOccluded_[sample],
                                            scene.tint(place.rayOrigin, direction_[sample]));
        }
        estimate.rays += static_cast<std::uint32_t>(queued);
        queued = 0;
    };
    for (std::size_t i = 0; i < size(); ++i) {
        if (direction_[i] == Vec3f(0, 0, 0)) continue;
        packet.set(queued, place.rayOrigin, direction_[i]);
        sampleOf[queued++] = i;
        if (queued == RayPacket::kSize) flush();
    }
    if (queued > 0) flush();

    double sum[3] = {0, 0, 0};
    double variance = 0;
    std::size_t i = 0;
    for (const std::size_t end : groupEnds_) {
        for (const std::size_t begin = i; i < end; ++i) {
            const Rgb& value = visible_[i] ? ifVisible_[i] : ifOccluded_[i];
            for (int c = 0; c < 3; ++c) sum[c] += static_cast<double>(value[c]);
            if ((i - begin) % 2 == 0) continue;
            // The squared difference of two neighbours estimates the variance of their sum.
            const Rgb& other = visible_[i - 1] ? ifVisible_[i - 1] : ifOccluded_[i - 1];
            const auto difference = static_cast<double>(environment.luminance(value - other));
            variance += difference * difference;
        }
    }
    for (int c = 0; c < 3; ++c) estimate.irradiance[c] += static_cast<float>(sum[c]);
    estimate.variance += static_cast<float>(variance);
}

}  // namespace shadowcache
