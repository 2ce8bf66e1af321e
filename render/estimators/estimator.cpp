#include "render/estimators/estimator.h"

#include <chrono>
#include <utility>

#include "common/base/error.h"
#include "common/base/suggestion.h"
#include "render/estimators/estimators.h"

namespace shadowcache {

namespace {

std::uint64_t nanoseconds() {
    return static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::nanoseconds>(
                                          std::chrono::steady_clock::now().time_since_epoch())
                                          .count());
}

constexpr EstimatorEntry kEstimators[] = {
    {"uniform", "directions uniform over the hemisphere", 1, false, makeUniform},
    {"cosine", "directions in proportion to the cosine", 1, false, makeCosine},
    {"environment", "directions in proportion to the map's luminance", 1, false, makeEnvironment},
    {"mis", "half environment, half cosine, balance heuristic", 1, false, makeMis},
    {"paper", "piecewise-constant importance over a triangulated map, times cached visibility", 1,
     false, makePaper},
    {"paper-image", "`paper` with its own cache: filled by the picture's earlier pixels", 1, false,
     makePaperImage},
    {"pixel", "importance from a low-resolution map", 1, false, makePixel},
    {"cache", "cached visibility as a control variate (needs --cache; the default with one)", 0,
     true, makeCache},
    {"pixel-printed", "`pixel` as the paper prints it", 1, false, makePixelPrinted,
     "pixels whose middle is below the horizon are left out"},
    {"preconvolved", "the map's irradiance as if nothing hid it, without rays", 0, false,
     makePreconvolved, "visibility is left out"},
    {"ambient-occlusion", "`preconvolved` times the open share of the hemisphere, from rays", 1,
     false, makeAmbientOcclusion, "visibility is one number for all directions"},
    {"ambient-occlusion-cached", "the same from the cache, without rays", 0, true,
     makeAmbientOcclusionCached, "visibility is one number for all directions, and cached"},
    {"lights", "a finite set of directional lights, one ray each", 0, false, makeLights,
     "the map is a few directional lights"},
};

}  // namespace

void LightSamples::clear() {
    direction_.clear();
    ifOpen_.clear();
    ifHidden_.clear();
    groupEnds_.clear();
}

void LightSamples::add(const Vec3f& direction, const Rgb& ifOpen, const Rgb& ifHidden) {
    direction_.push_back(direction);
    ifOpen_.push_back(ifOpen);
    ifHidden_.push_back(ifHidden);
}

void LightSamples::trace(const Scene& scene, const ShadingPoint& point,
                         const Environment& environment, Estimate& estimate) {
    open_.assign(size(), 0);
    RayPacket packet{};
    std::size_t sampleOf[RayPacket::kSize];
    int queued = 0;
    const auto flush = [&] {
        const std::uint32_t open = scene.visibility(packet, queued);
        for (int i = 0; i < queued; ++i) open_[sampleOf[i]] = (open >> i) & 1;
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
            const Rgb& value = open_[i] ? ifOpen_[i] : ifHidden_[i];
            for (int c = 0; c < 3; ++c) sum[c] += static_cast<double>(value[c]);
            if ((i - begin) % 2 == 0) continue;
            // The squared difference of two neighbours estimates the variance of their sum.
            const Rgb& other = open_[i - 1] ? ifOpen_[i - 1] : ifHidden_[i - 1];
            const auto difference = static_cast<double>(environment.luminance(value - other));
            variance += difference * difference;
        }
    }
    for (int c = 0; c < 3; ++c) estimate.irradiance[c] += static_cast<float>(sum[c]);
    estimate.variance += static_cast<float>(variance);
}

std::span<const std::uint32_t> Workspace::numbers(Sequence sequence, std::uint64_t seed,
                                                  int dimension, int count) {
    std::vector<std::uint32_t>& out = numbers_[dimension];
    out.resize(static_cast<std::size_t>(count));
    fillSequence(sequence, dimension, seed, out);
    return out;
}

std::unique_ptr<Workspace> Estimator::makeWorkspace() const {
    return std::make_unique<Workspace>();
}

CacheInsight Estimator::insight(const ShadingPoint&, int, Workspace&) const {
    return {};
}

std::uint64_t Estimator::survey(std::span<const ShadingPoint>, int) {
    return 0;
}

void Estimator::takeNote(Workspace&) const {}

void Estimator::exchange(std::span<const ShadingPoint>, Workspace&, std::span<Estimate>) const {}

void Estimator::estimate(std::span<const ShadingPoint> points, int samples, Workspace& workspace,
                         std::span<Estimate> estimates) const {
    std::uint64_t last = nanoseconds();
    const auto sinceLast = [&] {
        const std::uint64_t now = nanoseconds();
        return now - std::exchange(last, now);
    };
    for (std::size_t i = 0; i < points.size(); ++i) {
        workspace.samples.clear();
        estimates[i] = {};
        estimates[i].irradiance = prepare(points[i], samples, workspace);
        workspace.setupNanoseconds += sinceLast();
        if (workspace.samples.size() == 0) continue;
        workspace.samples.trace(context_.scene, points[i], context_.environment, estimates[i]);
        takeNote(workspace);
        workspace.traceNanoseconds += sinceLast();
    }
    exchange(points, workspace, estimates);
    workspace.traceNanoseconds += sinceLast();
}

Estimate Estimator::estimate(const ShadingPoint& point, int samples, Workspace& workspace) const {
    Estimate result;
    estimate({&point, 1}, samples, workspace, {&result, 1});
    return result;
}

std::span<const EstimatorEntry> estimatorTable() {
    return kEstimators;
}

std::string biasOf(const EstimatorEntry& entry, int samples) {
    if (entry.bias) return entry.bias;
    return samples > 0 ? "none" : "no rays: what the cache gets wrong stays";
}

const EstimatorEntry& findEstimator(const std::string& name) {
    std::vector<std::string> names;
    std::string known;
    for (const EstimatorEntry& entry : kEstimators) {
        if (name == entry.name) return entry;
        names.emplace_back(entry.name);
        known += (known.empty() ? "" : ", ") + names.back();
    }
    throw Error("--estimator " + name + ": wanted one of " + known + suggestion(name, names));
}

}  // namespace shadowcache
