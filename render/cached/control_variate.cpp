#include "render/cached/control_variate.h"

#include "common/predict/lanes.h"

namespace shadowcache {

namespace {

/// Sum over sixteen cells of weight times value.
double dot(const float* weight, const float* value) {
    alignas(64) float product[kBlockCells];
    for (int i = 0; i < kBlockCells; ++i) product[i] = weight[i] * value[i];
    return static_cast<double>(sumOf(product));
}

}  // namespace

ControlVariate::ControlVariate(const Environment& environment, const Regions& regions,
                               const SamplingPlan& plan) {
    for (std::size_t g = 0; g < regions.groups.size(); ++g) {
        const RegionGroup& group = regions.groups[g];
        addGroup(environment.cells(group.level, group.firstCell / kBlockCells), group,
                 plan.groups[g]);
    }
}

void ControlVariate::addGroup(const CellMoments& m, const RegionGroup& group,
                              const PlannedGroup& plan) {
    alignas(64) float c[kBlockCells], weight[kBlockCells];
    for (int i = 0; i < kBlockCells; ++i) {
        c[i] = plan.weight[i] > 0 ? plan.visibility[i] : 0.0f;
        weight[i] = c[i] * group.linear[i];
    }
    if (maximumOf(c) == 0) return;
    for (int k = 0; k < 3; ++k)
        for (int x = 0; x < 3; ++x) linear_[k][x] += dot(weight, m.firstMoment[k][x]);
    if (!group.cut) return;
    for (int i = 0; i < kBlockCells; ++i) weight[i] = c[i] * group.constant[i];
    // The trace of the second moment is the light itself.
    for (int k = 0; k < 3; ++k)
        for (int x = 0; x < 3; ++x) constant_[k] += dot(weight, m.second[k][x]);
    for (int i = 0; i < kBlockCells; ++i) weight[i] = c[i] * group.square[i];
    for (int k = 0; k < 3; ++k)
        for (int x = 0; x < 6; ++x) square_[k][x] += dot(weight, m.second[k][x]);
}

Rgb ControlVariate::integral(const Vec3f& normal) const {
    const auto x = static_cast<double>(normal.x), y = static_cast<double>(normal.y),
               z = static_cast<double>(normal.z);
    Rgb sum;
    for (int k = 0; k < 3; ++k) {
        const double* b = linear_[k];
        const double* d = square_[k];
        sum[k] = static_cast<float>(constant_[k] + b[0] * x + b[1] * y + b[2] * z + d[0] * x * x +
                                    d[1] * y * y + d[2] * z * z +
                                    2 * (d[3] * x * y + d[4] * x * z + d[5] * y * z));
    }
    return sum;
}

}  // namespace shadowcache
