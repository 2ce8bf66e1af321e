#include "render/cached/point_clusters.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/base/tuned.h"

namespace shadowcache {

namespace {

/// What a unit of normal counts beside a spacing of distance: the cosine changes faster than what
/// hides the sky.
SHADOWCACHE_TUNED(float, kNormalWeight, 2);
/// What a spacing of height over the mean plane counts beside a spacing of distance.
constexpr float kHeightWeight = 3;

/// Greatest extent of a cluster of many points, in spacings.
constexpr float kFineExtent = 0.35f;
/// Greatest extent of a cluster of few points: there a set-up costs more than a looser fit.
SHADOWCACHE_TUNED(float, kCoarseExtent, 1.4f);
/// Most points of a cluster that counts as one of few.
constexpr std::uint32_t kFewPoints = 32;
/// Pixels whose camera rays count as few points, whatever their number: where a cluster has fewer
/// points than a pixel, its samples hardly pay for the set-up.
constexpr std::uint32_t kFewPixels = 2;
/// Most samples of the points of such a cluster: more pay for a set-up of their own.
SHADOWCACHE_TUNED(std::uint32_t, kFewSamples, 128);

/// Normals whose mean is longer than this have a plane in common.
constexpr float kPlanar = 0.8f;

}  // namespace

std::span<const PointCluster> PointClusters::build(std::span<const ShadingPoint> points,
                                                   double spacing, std::uint32_t cameraRays,
                                                   int samples) {
    points_ = points;
    spacing_ = spacing;
    fewPoints_ = std::min(std::max(kFewPoints, kFewPixels * cameraRays),
                          kFewSamples / static_cast<std::uint32_t>(std::max(1, samples)));
    order_.resize(points.size());
    std::iota(order_.begin(), order_.end(), 0u);
    above_.resize(points.size());
    keys_.resize(points.size());
    clusters_.clear();
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec3f at((points[i].place.position - points[0].place.position) / spacing);
        const Vec3f normal = points[i].place.normal * kNormalWeight;
        keys_[i] = {{at.x, at.y, at.z, normal.x, normal.y, normal.z, 0, 0}};
    }
    if (!points.empty()) split(0, static_cast<std::uint32_t>(points.size()));
    return clusters_;
}

void PointClusters::split(std::uint32_t begin, std::uint32_t end) {
    const Extent extent = extentOf(begin, end);
    const std::uint32_t count = end - begin;
    if (extent.size <= kFineExtent || (extent.size <= kCoarseExtent && count <= fewPoints_))
        return addCluster(begin, end);
    const std::uint32_t middle = divide(begin, end, extent);
    if (middle == begin || middle == end) {  // an extent that floats cannot halve
        for (std::uint32_t i = begin; i < end; ++i) addCluster(i, i + 1);
        return;
    }
    split(begin, middle);
    split(middle, end);
}

std::uint32_t PointClusters::divide(std::uint32_t begin, std::uint32_t end, const Extent& extent) {
    const bool byHeight = extent.axis == kAxes;
    std::uint32_t middle = begin, above = 0;
    for (std::uint32_t i = begin; i < end; ++i) {
        const std::uint32_t point = order_[i];
        const float at = byHeight ? heightOf(extent.up, point) : keys_[point][extent.axis];
        // Written to both: the sides of neighbours cannot be foreseen.
        order_[middle] = above_[above] = point;
        middle += at < extent.middle ? 1 : 0;
        above += at < extent.middle ? 0 : 1;
    }
    std::copy_n(above_.begin(), above, order_.begin() + middle);
    return middle;
}

PointClusters::Extent PointClusters::extentOf(std::uint32_t begin, std::uint32_t end) const {
    Key low = keys_[order_[begin]], high = low;
    Key sum{};
    for (std::uint32_t i = begin; i < end; ++i) {
        const Key& key = keys_[order_[i]];
        for (std::size_t k = 0; k < key.at.size(); ++k) {
            low.at[k] = std::min(low.at[k], key.at[k]);
            high.at[k] = std::max(high.at[k], key.at[k]);
            sum.at[k] += key.at[k];
        }
    }
    Extent extent;
    for (std::size_t k = 0; k < kAxes; ++k)
        if (high[k] - low[k] > extent.size)
            extent = {high[k] - low[k], k, (high[k] + low[k]) / 2, Vec3f(0, 0, 0)};
    const Vec3f normals = Vec3f(sum[3], sum[4], sum[5]) / kNormalWeight;
    const float length = normals.length();
    if (!(length > kPlanar * static_cast<float>(end - begin))) return extent;
    const Vec3f up = normals * (kHeightWeight / length);
    float least = heightOf(up, order_[begin]), most = least;
    for (std::uint32_t i = begin + 1; i < end; ++i) {
        const float height = heightOf(up, order_[i]);
        least = std::min(least, height);
        most = std::max(most, height);
    }
    if (most - least > extent.size) extent = {most - least, kAxes, (most + least) / 2, up};
    return extent;
}

float PointClusters::heightOf(const Vec3f& up, std::uint32_t point) const {
    const Key& key = keys_[point];
    return up.x * key[0] + up.y * key[1] + up.z * key[2];
}

void PointClusters::addCluster(std::uint32_t begin, std::uint32_t end) {
    const float share = 1 / static_cast<float>(end - begin);
    Key mean{};
    for (std::uint32_t i = begin; i < end; ++i)
        for (std::size_t k = 0; k < mean.at.size(); ++k)
            mean.at[k] += share * keys_[order_[i]].at[k];
    PointCluster cluster{.members = std::span(order_).subspan(begin, end - begin),
                         .centre = order_[begin]};
    float nearest = std::numeric_limits<float>::max();
    for (std::uint32_t i = begin; i < end; ++i) {
        float distance = 0;
        for (std::size_t k = 0; k < mean.at.size(); ++k) {
            const float d = keys_[order_[i]].at[k] - mean.at[k];
            distance += d * d;
        }
        if (distance < nearest) nearest = distance, cluster.centre = order_[i];
    }
    const SetPlace& centre = points_[cluster.centre].place;
    double radius2 = 0;
    for (std::uint32_t i = begin; i < end; ++i) {
        const SetPlace& point = points_[order_[i]].place;
        cluster.tilt = std::max(cluster.tilt, point.normal.cross(centre.normal).length());
        // Beyond a right angle the sine would fall again.
        if (point.normal.dot(centre.normal) < 0) cluster.tilt = 1;
        radius2 = std::max(radius2, (point.position - centre.position).length2());
    }
    cluster.radius = static_cast<float>(std::sqrt(radius2));
    clusters_.push_back(cluster);
}

}  // namespace shadowcache
