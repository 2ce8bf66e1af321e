#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/trace/scene.h"
#include "render/estimators/estimator.h"
#include "render/estimators/light_samples.h"

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

/// Traces samples of a cluster's points in packets and adds what they bring to the points'
/// estimates.
class SampleTracer {
public:
    /// Samples that bring something whatever a ray finds, or what a ray decides.
    class Run {
    public:
        /// A sample that needs no ray.
        void add(std::uint32_t point, const Rgb& value);
        /// A sample whose value a ray decides.
        void trace(std::uint32_t point, const Vec3f& direction, const Rgb& ifVisible,
                   const Rgb& ifOccluded);
        /// A sample that is a misprediction if the ray finds the sky (`ifVisible`), or an occluder.
        ///
        /// @param received  from the sky
        void traceForReuse(const Misprediction& found, bool ifVisible, const Rgb& received);
        /// Traces what is still waiting.
        void finish();

    private:
        friend class SampleTracer;
        Run(SampleTracer& tracer, const EstimatorContext& context, const PointBatch& batch,
            std::vector<Misprediction>& found, std::span<Estimate> estimates)
            : tracer_(tracer),
              context_(context),
              batch_(batch),
              found_(found),
              estimates_(estimates) {}
        void queue(std::uint32_t point, const Vec3f& direction);
        void flush();
        /// What a ray brings that found the sky behind panes.
        Rgb tintedValue(int ray) const;

        SampleTracer& tracer_;
        const EstimatorContext& context_;
        const PointBatch& batch_;
        std::vector<Misprediction>& found_;
        std::span<Estimate> estimates_;
    };

    /// @param members    numbers of the points in the batch that samples will be of
    /// @param batch, estimates  are used until the run is finished
    /// @param found  mispredictions that are to be reused are added to it
    Run begin(const EstimatorContext& context, const PointBatch& batch,
              std::span<const std::uint32_t> members, std::vector<Misprediction>& found,
              std::span<Estimate> estimates);

private:
    /// What a ray that is still to be traced brings.
    struct Pending {
        std::uint32_t point;
        Rgb ifVisible, ifOccluded;
        Rgb predicted;  ///< received from the sky, if that is no misprediction
        int reuse;      ///< 1: a misprediction if visible, -1: if occluded, 0: neither
        Misprediction found;
    };
    /// Luminance of a point's last sample that has no partner yet.
    struct Partner {
        float luminance = 0;
        bool waits = false;
        bool paired = false;  ///< it had one before
    };

    RayPacket packet_{};
    Pending pending_[RayPacket::kSize];
    int queued_ = 0;
    std::span<const std::uint32_t> members_;
    std::vector<Partner> partners_;  ///< by point
};

}  // namespace shadowcache
