#pragma once

#include <vector>

#include "common/surface/surface.h"

namespace shadowcache {

/// How well the lobe of a cluster's central point stands for those of the others: the factor of
/// each colour that brings it nearest, over directions that the lobe itself draws.
class LobeMatch {
public:
    explicit LobeMatch(const GlossyLobe& central);

    struct Fit {
        Rgb factor{0, 0, 0};  ///< 0 where the other lobe is too different
        float misfit = 1;     ///< mean square of what remains, relative to the other lobe's
    };
    Fit fit(const GlossyLobe& lobe) const;

private:
    static constexpr int kLanes = GlossyLobe::kLanes;
    alignas(64) float direction_[3][kLanes];
    alignas(64) float value_[3][kLanes];
};

}  // namespace shadowcache
