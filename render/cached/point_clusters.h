#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "render/estimators/estimator.h"

namespace shadowcache {

/// Points that are alike enough for one set-up: near each other in place and normal, and in one
/// plane.
struct PointCluster {
    std::span<const std::uint32_t> members;  ///< numbers of its points, which ascend
    std::uint32_t centre = 0;  ///< number of the point that is nearest to the others' mean
    float tilt = 0;            ///< sine of the widest angle between its normal and another's
    float radius = 0;          ///< greatest distance from it to another [world]
};

/// Sorts the points of a batch into clusters. Buffers are used again from batch to batch.
class PointClusters {
public:
    /// @param spacing  of the cache's items [world], > 0
    /// @param cameraRays  of a pixel in the batch, > 0
    /// @param samples  of a point, on average; 0 for a prediction
    /// @return valid until the next call
    std::span<const PointCluster> build(std::span<const ShadingPoint> points, double spacing,
                                        std::uint32_t cameraRays, int samples);

private:
    static constexpr std::size_t kAxes = 6;
    /// Position in spacings, weighted normal, and two zeros: so many numbers fill a register.
    struct alignas(32) Key {
        std::array<float, 8> at{};
        float operator[](std::size_t axis) const { return at[axis]; }
    };

    struct Extent {
        float size = 0;
        std::size_t axis = 0;  ///< kAxes: height over the mean plane
        float middle = 0;
        Vec3f up{0, 0, 0};  ///< of that plane
    };

    void split(std::uint32_t begin, std::uint32_t end);
    /// Moves the points of `order_` below the middle of an extent to the front, in order.
    ///
    /// @return where the others begin
    std::uint32_t divide(std::uint32_t begin, std::uint32_t end, const Extent& extent);
    Extent extentOf(std::uint32_t begin, std::uint32_t end) const;
    void addCluster(std::uint32_t begin, std::uint32_t end);
    float heightOf(const Vec3f& up, std::uint32_t point) const;

    std::span<const ShadingPoint> points_;
    double spacing_ = 1;
    std::uint32_t fewPoints_ = 0;  ///< most points of a cluster that counts as one of few
    std::vector<Key> keys_;
    std::vector<std::uint32_t> order_, above_;  ///< points; those above a middle
    std::vector<PointCluster> clusters_;
};

}  // namespace shadowcache
