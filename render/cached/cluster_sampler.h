#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/random/sequence.h"
#include "render/estimators/shading_point.h"
#include "render/regions/region_distribution.h"

namespace shadowcache {

/// A sample of a cluster: for which point, and where in which region.
struct ClusterSample {
    std::uint32_t member;  ///< number of the point in the cluster
    RegionPlace place;
    float inverseCount;  ///< 1 / (number of samples expected of the point in the region)
    Environment::Draw draw;
    std::uint64_t jitter;

    EnvironmentSample finish(const Environment& environment) const {
        return environment.finishDraw(draw, toUnitFloat(static_cast<std::uint32_t>(jitter)),
                                      toUnitFloat(static_cast<std::uint32_t>(jitter >> 32)));
    }
};

/// How many samples a point has.
struct SampleCount {
    int drawn;
    double divisor;   ///< what they are divided by: their number, or the chance of the only one
    double expected;  ///< their number on average. Numbers of different points depend on each other
};

/// Samples of a cluster's points, in the order of its members.
struct ClusterCounts {
    std::span<const SampleCount> ofRegions;
    std::span<const SampleCount> ofLobes = {};  ///< drawn from the points' own lobes; may be none
    double judged = kJudgedSamples;  ///< of a point, by which it is judged which samples are heavy
    /// Irradiance from which on one of a point's samples is heavy [luminance]; empty: none is.
    std::span<const double> heavyFrom = {};
};

/// Rounds what is wanted of a cluster's points to numbers of samples, on average the same.
///
/// @param wanted  samples of each point, above 0, perhaps below 1
/// @param offset  in [0, 1), by chance: which points get one more
/// @return reused memory of `buffer`
std::span<const SampleCount> roundCounts(std::span<const double> wanted, double offset,
                                         std::vector<SampleCount>& buffer);

/// Draws the samples of a cluster from its distribution. All points draw from one sequence, one
/// after the other, so that the samples of a point, of a pixel and of the cluster are stratified
/// over the regions. Decided by their shares alone.
class ClusterSampler {
public:
    explicit ClusterSampler(const Environment& environment) : environment_(environment) {}

    /// @param members  numbers of the cluster's points, in the order of their pixels
    /// @param counts   of the members
    /// @return in the order of regions, so that neighbours are coherent; valid until the next call
    std::span<const ClusterSample> draw(const PointBatch& batch,
                                        std::span<const std::uint32_t> members,
                                        std::span<const SampleCount> counts,
                                        const RegionDistribution& distribution, Sequence sequence);

private:
    struct Number {
        std::uint64_t key;  ///< in [0, 1), in units of 2^-64
        std::uint32_t member;
        std::uint64_t jitter;
    };
    void drawNumbers(const PointBatch& batch, std::span<const std::uint32_t> members,
                     std::span<const SampleCount> counts, Sequence sequence);
    void sortNumbers();

    const Environment& environment_;
    std::vector<std::uint32_t> words_, bucketEnd_;
    std::vector<Number> numbers_, sorted_;
    std::vector<ClusterSample> samples_;
};

}  // namespace shadowcache
