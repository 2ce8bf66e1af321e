#pragma once

// Samples of points that emitters light.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "common/random/salts.h"
#include "common/random/sequence.h"
#include "render/estimators/shading_point.h"

namespace shadowcache {

/// Samples of a point: fewer of those that more camera rays of a pixel than asked for met.
inline int samplesOf(const PointBatch& batch, const BatchSlot& slot) {
    const float wanted = static_cast<float>(batch.samples) * slot.sampleFraction;
    return std::max(1, static_cast<int>(std::lround(wanted)));
}

/// Words of the samples of a point among those of its pixel.
inline void fillWords(const BatchSlot& slot, RenderSalt salt, int samples,
                      std::vector<std::uint32_t> (&words)[3]) {
    const std::uint64_t seed = hashWords(slot.seed, salt);
    const std::uint32_t first = slot.cameraRay * static_cast<std::uint32_t>(samples);
    for (int d = 0; d < 3; ++d) {
        words[d].resize(static_cast<std::size_t>(samples));
        owenSobol(first, d, seed, words[d]);
    }
}

/// Adds up values of samples that estimate the same thing, and the variance of their sum: the
/// squared difference of two neighbours estimates that of theirs.
struct SampleSum {
    const Rgb& luminanceWeights;
    Rgb value{0, 0, 0};
    float variance = 0;
    Rgb before{0, 0, 0};
    bool odd = false;

    void add(const Rgb& sample) {
        value += sample;
        if (odd) {
            const float difference = (sample - before).dot(luminanceWeights);
            variance += difference * difference;
        }
        before = sample;
        odd = !odd;
    }
};

/// Adds the samples of each point to its estimate.
template <class Samples, class Add>
void addUp(const Samples& samples, const Rgb& luminanceWeights, const Add& add) {
    for (std::size_t k = 0; k < samples.size();) {
        const std::uint32_t point = samples[k].point;
        SampleSum sum{luminanceWeights};
        std::uint32_t rays = 0;
        for (; k < samples.size() && samples[k].point == point; ++k) {
            sum.add(samples[k].visible ? samples[k].value : Rgb(0, 0, 0));
            rays += samples[k].traced ? 1 : 0;
        }
        add(point, sum.value, sum.variance, rays);
    }
}

}  // namespace shadowcache
