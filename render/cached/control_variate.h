#pragma once

#include "render/cached/sampling_plan.h"

namespace shadowcache {

/// The control variate's integral as a polynomial of a point's own normal n: with the cosine's
/// stand-in q(x) = q0 + q1 x + q2 x^2, x = n . w, of each region, c its visibility and L the light,
/// sum over the regions of c * integral of L q = A + B . n + n^T D n. Exact for every n, whatever
/// normal the coefficients were chosen for. [docs/estimator.md]
class ControlVariate {
public:
    ControlVariate(const Environment& environment, const Regions& regions,
                   const SamplingPlan& plan);

    Rgb integral(const Vec3f& normal) const;

private:
    void addGroup(const CellMoments& m, const RegionGroup& group, const PlannedGroup& plan);

    double constant_[3] = {};   ///< A, by colour
    double linear_[3][3] = {};  ///< B
    double square_[3][6] = {};  ///< D: xx, yy, zz, xy, xz, yz
};

}  // namespace shadowcache
