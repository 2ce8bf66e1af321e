#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/light/environment.h"
#include "render/cached/region_weights.h"

namespace shadowcache {

/// A region that a sample was drawn from.
struct Region {
    int level;
    std::uint32_t cell;
    float visibility;  ///< c: the control variate's coefficient
    float shared;      ///< RegionWeights::shared()
};

/// Draws the directions of one point's samples in proportion to the spreads of its regions and, in
/// a region, to the light. Decided by the weights alone. Arrays are reused from point to point.
class RegionSampler {
public:
    explicit RegionSampler(const Environment& environment) : environment_(environment) {}

    /// Shares `samples` samples (>= 1) out: regions due many get strata of their own, all others
    /// share the rest. The sum of the weights' spreads must be positive; in their place it leaves
    /// the number of samples of each region, or the mean number where chance decides.
    ///
    /// @param words  numbers of a sequence, as many as samples: for their places in the strata
    void draw(RegionWeights& weights, int samples, std::span<const std::uint32_t> words,
              std::uint64_t seed);

    /// A direction drawn.
    struct Drawn {
        Region region;
        EnvironmentSample light;
        double share;    ///< 1 / (number of samples expected in the region)
        bool endsGroup;  ///< the last of those that estimate the same thing
    };
    std::size_t size() const { return queued_.size(); }
    Drawn drawn(std::size_t i) const;

private:
    struct Queued {
        Region region;
        double share;
        Environment::Draw draw;
        std::uint64_t jitter;
        bool endsGroup;
    };
    struct Own {
        Region region;
        double spread;
        float* place;  ///< of the spread in the weights
        int count = 0;
    };

    /// Takes the regions whose spread is at least `least` from the groups; false if there are none.
    bool takeOwn(RegionWeights& weights, double least);
    void returnOwn();
    void sumGroups(const RegionWeights& weights);
    void drawOwn(double perSpread);
    void drawRest(const RegionWeights& weights, int count);
    void countSamples(RegionWeights& weights);
    void queue(const Region& region, double place, double share);
    void endGroup();
    double nextNumber();
    void nextHash();

    const Environment& environment_;
    std::span<const std::uint32_t> words_;
    std::uint64_t hashBase_ = 0;  ///< of the hashes of all samples
    std::uint64_t hash_ = 0;      ///< of the sample whose number was the last
    std::size_t used_ = 0;        ///< of words_
    std::vector<Own> own_;
    double ownSum_ = 0;
    std::vector<double> groupSum_;
    double restSum_ = 0;
    double perSpread_ = 0;
    std::vector<Queued> queued_;
};

}  // namespace shadowcache
