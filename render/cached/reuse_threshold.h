#pragma once

#include <array>
#include <cstddef>

#include "render/cached/regions.h"
#include "render/cached/sampling_plan.h"

namespace shadowcache {

/// Chooses for a frame how heavy a misprediction must be to be reused. In vegetation finds are so
/// many that their rays cost more than they gain. So the pilot's places are planned with each
/// threshold, and the higher one is taken where it clearly lowers the predicted error times cost.
/// [docs/estimator.md]
class ReuseThreshold {
public:
    /// Values of Heavy::least.
    inline static const std::array kChoices{kHeavy, kVeryHeavy};

    /// Adds a place as planned with kChoices[choice].
    ///
    /// @param share   samples of the place over the frame's mean, > 0
    /// @param weight  of its squared error: 1 / (square of its brightness)
    void add(std::size_t choice, const Regions& regions, const SamplingPlan& plan, double share,
             double weight);
    /// Adds the places of another one.
    void add(const ReuseThreshold& other);

    /// The best of kChoices; the first if no place has any noise.
    double best() const;

private:
    std::array<double, 2> error_{};  ///< sum over places of weight * variance
    std::array<double, 2> cost_{};   ///< sum over places, in samples
};

}  // namespace shadowcache
