#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "render/cached/cluster_sampler.h"
#include "render/cached/point_clusters.h"
#include "render/cached/sample_tracer.h"
#include "render/regions/region_builder.h"

namespace shadowcache {

/// Pixels of a group whose points are mispredicted with a probability of `chance`, before it is
/// rounded to a power of two.
///
/// @param perFind  pixels for each that is mispredicted, on average
double pixelsOfGroup(double chance, double perFind);

/// Points of neighbouring pixels reuse each other's mispredictions, each of which is rare and
/// heavy: multi-sample MIS. A point takes part in what another found with the balance heuristic
/// over all points of its group that are mispredicted in that direction, too. Groups hold one row
/// of some pixels: one camera ray of each, or more where a pixel has more; groups with so few
/// mispredicted points that each would receive too much reuse the direction together. Unbiased,
/// because groups, densities, and whether a point is mispredicted, do not depend on the samples.
/// [docs/estimator.md; Bekaert et al. 2002 for the reuse of paths]
template <Integrand I>
class NeighborReuse {
public:
    explicit NeighborReuse(const Environment& environment);

    /// A batch under way: clusters are planned and sampled, then all mispredictions are reused,
    /// once.
    class Batch {
    public:
        /// The next cluster: its regions whose mispredictions are reused, and the samples that its
        /// points have or are expected to have.
        ///
        /// @param heavyFrom  for each point, irradiance [luminance] from which on a sample is
        /// heavy; empty: none is
        void addCluster(const Regions& regions, const SamplingPlan& plan,
                        const RegionDistribution& distribution,
                        std::span<const std::uint32_t> members, std::span<const SampleCount> counts,
                        std::span<const double> heavyFrom);
        /// Mispredictions of the samples are to be added.
        std::vector<Misprediction>& found() { return reuse_.found_; }
        /// Adds to the points' estimates what all mispredictions contribute, the finders' share
        /// too.
        void finish(const Scene& scene, std::span<Estimate> estimates);

    private:
        friend class NeighborReuse;
        explicit Batch(NeighborReuse& reuse) : reuse_(reuse) {}
        NeighborReuse& reuse_;
    };

    /// @param batch, clusters, points  are read until the batch is finished
    Batch begin(const PointBatch& batch, const PointClusters& clusters,
                const typename I::Points& points);

private:
    /// Of sixteen regions: PlannedGroup::reuse, and the probability of a misprediction.
    struct Offer {
        float reuse[kBlockCells];
        float chance[kBlockCells];
    };
    struct ClusterOffers {
        explicit ClusterOffers(const Environment& environment) : distribution(environment) {}

        RegionDistribution distribution;
        std::vector<Offer> offers;  ///< as Regions::groups
        double samples = 0;         ///< of all its points
    };
    /// What a cluster offers in the region that holds a direction.
    struct Offered {
        bool visible = false;  ///< what is mispredicted there
        float chance = 0;
        double samples = 0;  ///< there, for each of a point; 0: nothing is offered
        double density = 0;  ///< of one sample of a point, along the direction
    };
    /// A point that a misprediction may concern.
    struct Candidate {
        std::uint32_t point;
        double density;  ///< of all its samples, along the direction
        bool visible;    ///< what would contradict its prediction
        bool isKnown;    ///< to be mispredicted: it found the direction, or a ray told
    };

    /// What a misprediction contributes to a point; `density`, of all that may find it, is negative
    /// where light that was predicted is missing.
    Rgb received(std::uint32_t point, const Misprediction& found, double density) const {
        return found.radiance * points_.value(point, found.direction, density);
    }
    static Offered offered(const ClusterOffers& cluster, const Misprediction& found);
    std::uint32_t groupSize(const Misprediction& found);
    void findMispredicted(const Misprediction& found, const Scene& scene,
                          std::span<Estimate> estimates);
    static double sumOfDensities(std::span<const Candidate> candidates);
    /// Whether what the mispredicted points of one pixel of a group would receive is too heavy.
    bool isTooHeavy(const Misprediction& found, std::span<const Candidate> group) const;
    /// Removes the groups that are not too heavy; candidates come group by group.
    void keepTooHeavyGroups(const Misprediction& found, std::uint32_t size);
    /// Adds the points of some pixels of one row that may be mispredicted.
    void addCandidates(const Misprediction& found, std::uint32_t row, std::uint32_t first,
                       std::uint32_t last);
    void addCandidate(const Misprediction& found, std::uint32_t point);
    void keepMispredicted(const Misprediction& found, const Scene& scene,
                          std::span<Estimate> estimates);
    void contribute(const Misprediction& found, std::span<Estimate> estimates);

    const Environment& environment_;

    PointBatch batch_;
    typename I::Points points_;
    const PointClusters* clusters_ = nullptr;
    std::vector<ClusterOffers> offers_;  ///< by cluster; only the first count_ are of this batch
    std::size_t count_ = 0;
    std::vector<std::uint32_t> clusterOf_;  ///< by point
    std::vector<double> samples_;           ///< by point
    std::vector<double> tooHeavyFrom_;      ///< by point [luminance]
    std::uint32_t rows_ = 0;                ///< of the batch's points
    std::vector<std::int32_t> pointAt_;     ///< first of a row and pixel; -1: none
    std::vector<Misprediction> found_;

    std::vector<std::uint32_t> sizes_;      ///< groupSize() by cell
    std::vector<std::uint32_t> sizeBatch_;  ///< number of the batch that it is of
    std::uint32_t batchNumber_ = 0;
    std::vector<Offered> offered_;              ///< by cluster, for one misprediction
    std::vector<std::uint32_t> offeredNumber_;  ///< number of the misprediction that it is of
    std::uint32_t foundNumber_ = 0;
    std::vector<Candidate> candidates_, ownGroup_;
    std::vector<float> pixelReceived_;  ///< of one misprediction [luminance]
};

}  // namespace shadowcache
