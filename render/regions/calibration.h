#pragma once

#include <array>
#include <bit>
#include <cstdint>

namespace shadowcache {

/// Calibrates the predicted visibility against pilot rays: of the regions that the counts predict
/// to be visible with probability a, which share was visible? Before the first ray is added it is a
/// itself. [docs/estimator.md]
class Calibration {
public:
    /// Least uncertainty that any counts leave: a probability is at least this far from 0 and
    /// from 1.
    static constexpr float kLeastUncertainty = 1e-6f;

    Calibration();

    /// Adds a ray into a region whose predicted visibility is `a`. Not thread-safe.
    void add(float a, bool visible);
    /// Adds the rays of another one.
    void add(const Calibration& other);
    /// Brings apply() up to date with what was added.
    void update();

    /// Calibrated prediction for a region whose counts predict visibility `a`.
    struct Calibrated {
        float posterior;  ///< probability that its light is seen, in (0, 1)
        /// The visibility v that the counts give is corrected to slope v + offset, which is v
        /// except where they are wrong by more than chance and rounding explain.
        float slope, offset;
    };
    Calibrated apply(float a) const {
        Calibrated calibrated;
        apply<1>(&a, &calibrated.posterior, &calibrated.slope, &calibrated.offset);
        return calibrated;
    }
    /// The same of `count` regions at once: loops that become vectors.
    template <int count>
    void apply(const float* a, float* posterior, float* slope, float* offset) const {
        float uncertainty[count], factor[count];
        std::uint32_t bin[count];
        for (int i = 0; i < count; ++i) {
            uncertainty[i] = uncertaintyOf(a[i]);
            bin[i] = binOf(a[i], uncertainty[i]);
        }
        for (int i = 0; i < count; ++i) {
            factor[i] = factor_[bin[i]];
            slope[i] = slope_[bin[i]];
            offset[i] = offset_[bin[i]];
        }
        for (int i = 0; i < count; ++i) {
            // Uncertainties of one bin differ by half an octave: what is right for their mean may
            // pass 1.
            const float moved = uncertainty[i] * factor[i];
            const float corrected = moved < 1 - kLeastUncertainty ? moved : 1 - kLeastUncertainty;
            posterior[i] = a[i] > 0.5f ? 1 - corrected : corrected;
        }
    }

private:
    /// Half octaves of uncertainty, from 2^-20 to 1/2, once for a <= 1/2 and once for a > 1/2.
    static constexpr int kBinsPerSide = 40;
    static constexpr int kBins = 2 * kBinsPerSide;

    static float uncertaintyOf(float a) {
        const float uncertainty = a > 0.5f ? 1 - a : a;
        return uncertainty > kLeastUncertainty ? uncertainty : kLeastUncertainty;
    }
    static std::uint32_t binOf(float a, float uncertainty) {
        // Exponent and first bit of the mantissa: half octaves above 2^-20.
        constexpr std::uint32_t kFirst = (127 - 20) << 1;
        const std::uint32_t bin = (std::bit_cast<std::uint32_t>(uncertainty) >> 22) - kFirst;
        const std::uint32_t last = kBinsPerSide - 1;
        return (bin < last ? bin : last) + kBinsPerSide * static_cast<std::uint32_t>(a > 0.5f);
    }

    /// Rays that were visible over those that the counts predict to be.
    double lightFound() const;

    std::array<std::uint64_t, kBins> visible_{}, rays_{};
    std::array<double, kBins> sum_{};  ///< of a, over the rays
    alignas(64) std::array<float, kBins> factor_;
    alignas(64) std::array<float, kBins> slope_;
    alignas(64) std::array<float, kBins> offset_{};
};

}  // namespace shadowcache
