#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/predict/grouped_light.h"
#include "common/random/sequence.h"
#include "render/estimators/light_samples.h"
#include "render/estimators/shading_point.h"

namespace shadowcache {

/// A sample of a pixel that is watched.
struct WatchedSample {
    std::uint32_t cameraRay;
    Vec3f direction;  ///< zero: no ray, contributes nothing
};

/// Scratch memory of one thread; estimators derive their own.
struct Workspace {
    virtual ~Workspace() = default;

    /// A pixel of the batch whose own samples are to be noted, for reports.
    std::optional<std::uint32_t> watchedPixel;
    std::vector<WatchedSample> watched;

    void watch(const BatchSlot& slot, const Vec3f& direction) {
        if (watchedPixel == slot.pixel) watched.push_back({slot.cameraRay, direction});
    }

    /// Of the points that were lit last, by number, in the unit of their estimates; for an
    /// estimator whose context has groups and emitters, else empty.
    GroupedLight groups;

    LightSamples samples;
    std::uint64_t setupNanoseconds = 0;
    std::uint64_t traceNanoseconds = 0;
    std::uint64_t pointsWithoutItems = 0;  ///< lit without what a cache knows

    /// Words `first` to `first + count - 1` of dimension `dimension` of a sequence; valid until the
    /// next call with that dimension.
    std::span<const std::uint32_t> numbers(Sequence sequence, std::uint64_t seed, int dimension,
                                           std::uint32_t first, int count);

private:
    std::vector<std::uint32_t> numbers_[4];
};

}  // namespace shadowcache
