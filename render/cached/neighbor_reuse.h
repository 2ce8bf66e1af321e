#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "common/trace/scene.h"
#include "render/cached/cluster_sampler.h"
#include "render/cached/point_clusters.h"

namespace shadowcache {

/// A direction in which a sample found the sky where the cache predicts an occluder, or an occluder
/// where it predicts the sky.
struct Misprediction {
    Vec3f direction;
    Rgb radiance;
    std::uint32_t cell;    ///< of level Environment::kLevel, that holds the light
    double lightDensity;   ///< density of samples in proportion to the light [radiance]
    std::uint32_t finder;  ///< number of the point
};

/// Pixels of a group whose points are mispredicted with a probability of `chance`, before it is
/// rounded to a power of two.
double pointsOfGroup(double chance);

/// Points of neighbouring pixels reuse each other's mispredictions, each of which is rare and
/// heavy: multi-sample MIS. A point takes part in what another found with the balance heuristic
/// over all points of its group that are mispredicted in that direction, too. Groups hold one row
/// of some pixels: one camera ray of each, or more where a pixel has more; groups with so few
/// mispredicted points that each would receive too much reuse the direction together. Unbiased,
/// because groups, densities, and whether a point is mispredicted, do not depend on the samples.
/// [docs/estimator.md; Bekaert et al. 2002 for the reuse of paths]
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
        /// @param ofLobes  samples of the points' lobes beside them, of a batch of glossy points
        void addCluster(const Regions& regions, const SamplingPlan& plan,
                        const RegionDistribution& distribution,
                        std::span<const std::uint32_t> members, std::span<const PointShare> shares,
                        std::span<const double> heavyFrom,
                        std::span<const PointShare> ofLobes = {});
        void add(const Misprediction& found) { reuse_.found_.push_back(found); }
        /// Adds to the points' estimates what all mispredictions contribute, the finders' share
        /// too.
        void finish(const Scene& scene, std::span<Estimate> estimates);

    private:
        friend class NeighborReuse;
        explicit Batch(NeighborReuse& reuse) : reuse_(reuse) {}
        NeighborReuse& reuse_;
    };

    /// @param batch, clusters, glossy  are read until the batch is finished
    /// @param glossy  the batch's points with their lobes, which are then lit in place of the
    /// cosine
    Batch begin(const PointBatch& batch, const PointClusters& clusters,
                std::span<const GlossyPoint> glossy = {});

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
    };

    double densityOf(std::uint32_t point, const Offered& offer, const Vec3f& direction) const;
    /// What a misprediction contributes to a point; `density`, of all that may find it, is negative
    /// where light that was predicted is missing.
    Rgb received(std::uint32_t point, const Misprediction& found, double density) const;
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
    std::span<const GlossyPoint> glossy_;
    const PointClusters* clusters_ = nullptr;
    std::vector<ClusterOffers> offers_;  ///< by cluster; only the first count_ are of this batch
    std::size_t count_ = 0;
    std::vector<std::uint32_t> clusterOf_;  ///< by point
    std::vector<double> samples_;           ///< by point
    std::vector<double> lobeSamples_;       ///< by glossy point
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
    std::vector<Candidate> candidates_;
    std::vector<float> pixelReceived_;  ///< of one misprediction [luminance]
};

}  // namespace shadowcache
