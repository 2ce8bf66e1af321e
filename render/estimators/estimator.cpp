#include "render/estimators/estimator.h"

#include <utility>

#include "common/base/tuned.h"

namespace shadowcache {

namespace {

/// Places of the frame that a pilot looks at.
SHADOWCACHE_TUNED(std::size_t, kPilotPlaces, 1024);

}  // namespace

void LightSamples::clear() {
    direction_.clear();
    ifVisible_.clear();
    ifOccluded_.clear();
    groupEnds_.clear();
}

void LightSamples::add(const Vec3f& direction, const Rgb& ifVisible, const Rgb& ifOccluded) {
    direction_.push_back(direction);
    ifVisible_.push_back(ifVisible);
    ifOccluded_.push_back(ifOccluded);
}

void LightSamples::trace(const Scene& scene, const ShadingPoint& point,
                         const Environment& environment, Estimate& estimate) {
    visible_.assign(size(), 0);
    RayPacket packet{};
    std::size_t sampleOf[RayPacket::kSize];
    int queued = 0;
    const auto flush = [&] {
        const std::uint32_t visible = scene.visibility(packet, queued);
        for (int i = 0; i < queued; ++i) visible_[sampleOf[i]] = (visible >> i) & 1;
        estimate.rays += static_cast<std::uint32_t>(queued);
        queued = 0;
    };
    for (std::size_t i = 0; i < size(); ++i) {
        if (direction_[i] == Vec3f(0, 0, 0)) continue;
        packet.set(queued, point.rayOrigin, direction_[i]);
        sampleOf[queued++] = i;
        if (queued == RayPacket::kSize) flush();
    }
    if (queued > 0) flush();

    double sum[3] = {0, 0, 0};
    double variance = 0;
    std::size_t i = 0;
    for (const std::size_t end : groupEnds_) {
        for (const std::size_t begin = i; i < end; ++i) {
            const Rgb& value = visible_[i] ? ifVisible_[i] : ifOccluded_[i];
            for (int c = 0; c < 3; ++c) sum[c] += static_cast<double>(value[c]);
            if ((i - begin) % 2 == 0) continue;
            // The squared difference of two neighbours estimates the variance of their sum.
            const Rgb& other = visible_[i - 1] ? ifVisible_[i - 1] : ifOccluded_[i - 1];
            const auto difference = static_cast<double>(environment.luminance(value - other));
            variance += difference * difference;
        }
    }
    for (int c = 0; c < 3; ++c) estimate.irradiance[c] += static_cast<float>(sum[c]);
    estimate.variance += static_cast<float>(variance);
}

std::span<const std::uint32_t> Workspace::numbers(Sequence sequence, std::uint64_t seed,
                                                  int dimension, std::uint32_t first, int count,
                                                  std::uint32_t total) {
    std::vector<std::uint32_t>& out = numbers_[dimension];
    out.resize(static_cast<std::size_t>(count));
    fillSequence(sequence, dimension, seed, first, total, out);
    return out;
}

std::size_t FramePilot::places(std::uint64_t) const {
    return kPilotPlaces;
}

std::unique_ptr<Workspace> Estimator::makeWorkspace() const {
    return std::make_unique<Workspace>();
}

void PointEstimator::estimate(const PointBatch& batch, Workspace& workspace,
                              std::span<Estimate> estimates) const {
    Stopwatch watch;
    for (std::size_t i = 0; i < batch.points.size(); ++i) {
        const ShadingPoint& point = batch.points[i];
        workspace.samples.clear();
        estimates[i] = {};
        estimates[i].irradiance = prepare(point, sliceOf(batch, point), workspace);
        workspace.setupNanoseconds += watch.sinceLast();
        if (workspace.samples.size() == 0) continue;
        for (std::size_t j = 0; workspace.watchedPixel && j < workspace.samples.size(); ++j)
            workspace.watch(point, workspace.samples.direction(j));
        workspace.samples.trace(context_.scene, point, context_.environment, estimates[i]);
        workspace.traceNanoseconds += watch.sinceLast();
    }
}

void Estimator::estimate(std::span<const ShadingPoint> points, int samples, Workspace& workspace,
                         std::span<Estimate> estimates) const {
    std::vector<ShadingPoint> alone(points.begin(), points.end());
    for (std::size_t i = 0; i < alone.size(); ++i) {
        alone[i].pixel = static_cast<std::uint32_t>(i);
        alone[i].cameraRay = alone[i].row = 0;
    }
    PointBatch batch{alone, samples, static_cast<std::uint32_t>(alone.size())};
    batch.pixelSamples = static_cast<std::uint32_t>(samples);
    estimate(batch, workspace, estimates);
}

Estimate Estimator::estimate(const ShadingPoint& point, int samples, Workspace& workspace) const {
    Estimate result;
    estimate({&point, 1}, samples, workspace, {&result, 1});
    return result;
}

std::uint64_t Stopwatch::sinceLast() {
    const auto now = std::chrono::steady_clock::now();
    const auto passed = now - std::exchange(last_, now);
    return static_cast<std::uint64_t>(
        std::chrono::duration_cast<std::chrono::nanoseconds>(passed).count());
}

}  // namespace shadowcache
