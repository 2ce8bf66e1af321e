#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "common/light/environment.h"
#include "render/cached/region_weights.h"
#include "render/estimators/estimator.h"

namespace shadowcache {

/// A direction in which a sample found the sky where the cache is sure there is none, or an
/// occluder where it is sure of the sky.
struct Surprise {
    Vec3f direction;
    Rgb radiance;
    std::uint32_t cell;   ///< of level Environment::kLevel, that holds the light
    double lightDensity;  ///< density of samples in proportion to the light [radiance]
    std::size_t finder;   ///< number of the point
    bool open;
};

/// Neighbouring points tell one another of surprises, each of which is rare and heavy: a point
/// takes part in what the others find with the balance heuristic over all points that would have
/// been surprised by that direction. Unbiased, because whether a point is surprised by a direction
/// depends on the set alone. [docs/estimator.md; Bekaert et al. 2002 for the reuse of paths]
class SurpriseExchange {
public:
    explicit SurpriseExchange(const DirectionTiers& tiers);

    /// Forgets all points.
    void clear() { size_ = 0, surprises_.clear(); }
    /// The next point, none of whose regions is shared unless offer() says so.
    void addPoint();
    /// The shared regions of the last point; their spreads are the numbers of their samples.
    void offer(const RegionWeights& weights);
    /// Number of the last point.
    std::size_t lastPoint() const { return size_ - 1; }
    void add(const Surprise& surprise) { surprises_.push_back(surprise); }

    /// Adds to every point's estimate what its neighbours' and its own surprises contribute.
    void exchange(const Scene& scene, const Environment& environment,
                  std::span<const ShadingPoint> points, std::span<Estimate> estimates);

private:
    /// Samples expected in each of sixteen cells; negative where the cache is sure of the sky; 0
    /// where nothing is shared.
    using Expected = std::array<float, kBlockCells>;

    /// The shared regions of a point.
    struct Offers {
        std::vector<std::int16_t> slots;  ///< in `expected`, by block of the tiers; -1: none
        std::vector<std::uint16_t> used;  ///< slots that are not -1
        std::vector<Expected> expected;
    };
    /// A point that a surprise may concern.
    struct Candidate {
        std::size_t point;
        double density;  ///< of samples of all its own, along the direction
        bool open;       ///< what would surprise it
    };

    void findCandidates(const Surprise& surprise, const Environment& environment,
                        std::span<const ShadingPoint> points);
    void keepSurprised(const Surprise& surprise, const Scene& scene,
                       std::span<const ShadingPoint> points, std::span<Estimate> estimates);

    int baseLevel_;
    std::vector<std::uint32_t> firstSlot_;  ///< by tier
    std::vector<Offers> offers_;            ///< by point; only the first size_ count
    std::size_t size_ = 0;
    std::vector<Surprise> surprises_;
    std::vector<Candidate> candidates_;
};

}  // namespace shadowcache
