#pragma once

#include <array>
#include <span>
#include <vector>

#include "render/bounces/direction_guide.h"
#include "render/estimators/estimator.h"

namespace shadowcache {

/// A place where guided rays start; places are relative to the set's origin, normals unit.
struct GuidePlace {
    Vec3f origin, normal, geometricNormal;
};

/// Finds out by trial rays where the light that bounces to near places comes from. They are none of
/// a picture's, so that a guide adds no bias.
class GuideMaker {
public:
    /// @param context  with a RadiosityTree
    explicit GuideMaker(const EstimatorContext& context)
        : context_(context), tree_(*context.radiosity) {}

    /// A guide for places that are near each other; by the cosine where no other one pays.
    ///
    /// @param seed  of the trial rays
    DirectionGuide make(std::span<const GuidePlace> places, std::uint64_t seed);

    std::uint64_t rays() const { return rays_; }

private:
    /// What trial rays found of a ball, summed over them.
    struct Trial {
        RadiosityTree::Ball ball;
        double light = 0;   ///< irradiance from it, in luminance
        double extent = 0;  ///< projected solid angle [sr]
    };
    /// Balls to guide rays to.
    struct Best {
        std::vector<Trial> trials;
        float share;  ///< of guided rays; 0: none pays
    };
    struct Queued {
        std::size_t ball;
        double weight;  ///< of its radiance in the irradiance
    };

    void sendTrials(std::span<const GuidePlace> places, std::uint64_t seed, int first, int last);
    void queue(const Queued& ray, const Vec3f& origin, const Vec3f& direction);
    void flush();
    float radianceMet(const Hit& hit, const Vec3f& direction) const;
    double predictedAt(const GuidePlace& place) const;
    Best best(double predicted, double gain) const;

    const EstimatorContext& context_;
    const RadiosityTree& tree_;
    std::vector<Trial> trials_;
    int sent_ = 0;  ///< trial rays to each
    RayPacket packet_{};
    std::array<Queued, RayPacket::kSize> queued_{};
    std::size_t count_ = 0;
    std::uint64_t rays_ = 0;
};

}  // namespace shadowcache
