#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/cached/cluster_offers.h"
#include "render/cached/memo.h"
#include "render/cached/pixel_rows.h"
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
    explicit NeighborReuse(const Environment& environment) : environment_(environment) {}

    /// The points that mispredictions may concern.
    struct Receivers {
        const Scene& scene;
        const PointBatch& batch;
        const typename I::Points& points;  ///< their integrands
        std::span<Estimate> estimates;
    };
    /// Adds to the estimates what all mispredictions contribute, the finders' share too.
    void share(std::span<const Misprediction> found, const ClusterOffers& offers,
               const Receivers& receivers);

private:
    /// A point that a misprediction may concern.
    struct Candidate {
        std::uint32_t point;
        double density;  ///< of all its samples, along the direction
        bool visible;    ///< what would contradict its prediction
        bool isKnown;    ///< to be mispredicted: it found the direction, or a ray told
    };
    /// One misprediction of a batch.
    struct Task {
        const Misprediction& found;
        const ClusterOffers& offers;
        const Receivers& receivers;

        const BatchSlot& slot(const Candidate& c) const {
            return receivers.batch.points[c.point].slot;
        }
        /// What it contributes to a point; `density`, of all that may find it, is negative where
        /// light that was predicted is missing.
        Rgb received(const Candidate& c, double density) const {
            return found.radiance * receivers.points.value(c.point, found.direction, density);
        }
    };

    std::uint32_t groupSize(const Task& task);
    /// The candidates become the points that reuse the direction.
    void findMispredicted(const Task& task);
    /// Whether what the mispredicted points of one pixel of a group would receive is too heavy.
    bool isTooHeavy(const Task& task, std::span<const Candidate> group) const;
    /// Removes the groups that are not too heavy; candidates come group by group.
    void keepTooHeavyGroups(const Task& task, std::uint32_t size);
    /// Adds the points of pixels `first` .. `end - 1` of a row that may be mispredicted.
    void addCandidates(const Task& task, std::uint32_t row, std::uint32_t first, std::uint32_t end);
    void addCandidate(const Task& task, std::uint32_t point);
    /// Removes the candidates that are not mispredicted.
    void keepMispredicted(const Task& task);
    void contribute(const Task& task);

    const Environment& environment_;
    PixelRows rows_;
    Memo<std::uint32_t> groupSizes_;      ///< by cell, for a batch
    Memo<ClusterOffers::Offer> offered_;  ///< by cluster, for a misprediction
    std::vector<Candidate> candidates_, ownGroup_;
    std::vector<Rgb> received_;         ///< by candidate
    std::vector<float> pixelReceived_;  ///< of one misprediction [luminance]
};

}  // namespace shadowcache
