#include "bake/app/estimate.h"

#include <fmt/core.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <string>

#include "bake/core/region_bytes.h"
#include "common/base/json_file.h"
#include "common/base/percent_text.h"
#include "common/base/process.h"

namespace shadowcache {

namespace {

/// Memory of a bake, in sizes of its items, when it writes them: regions as they were finished,
/// their sum, and the grids. Measured on the kitchen and the dragon.
constexpr double kCopies = 4;

std::uint64_t rounded(double value) {
    return static_cast<std::uint64_t>(std::llround(value));
}

/// Size of the file that the sample makes; the file is removed.
std::uintmax_t fileBytes(const BakeSample& sample) {
    if (sample.items.size() == 0) return 0;
    const auto path = std::filesystem::temp_directory_path() /
                      fmt::format("shadowcache-estimate-{}.vdb", getpid());
    const std::uintmax_t bytes = writeCache(path, sample.header, sample.items);
    std::filesystem::remove(path);
    return bytes;
}

}  // namespace

BakeEstimate estimateBake(const Scene& scene, const BakeOptions& options,
                          const VoxelSelection& selection, double secondsBefore) {
    const BakeSample sample = sampleBake(scene, options, selection);
    const std::uint64_t memory = peakMemoryBytes();
    const double start = secondsNow();
    const std::uintmax_t bytes = fileBytes(sample);
    const double writing = secondsNow() - start;
    const auto ratio = [](std::size_t whole, std::size_t part) {
        return part == 0 ? 0.0 : static_cast<double>(whole) / static_cast<double>(part);
    };
    const double scale = ratio(sample.ofVoxels, sample.voxels);
    const double probeScale = ratio(sample.ofProbes, sample.probes);
    BakeEstimate estimate;
    estimate.sampled = ratio(sample.voxels, sample.ofVoxels);
    estimate.spacing = sample.header.spacing;
    estimate.level = sample.header.level;
    estimate.items = rounded(scale * static_cast<double>(sample.items.size()));
    estimate.rays = rounded(probeScale * static_cast<double>(sample.probeRays) +
                            scale * static_cast<double>(sample.itemRays));
    estimate.emitters = sample.header.emitters.size();
    estimate.emitterRays = rounded(scale * static_cast<double>(sample.emitterRays));
    estimate.seconds =
        secondsBefore + probeScale * sample.probeSeconds + scale * (sample.itemSeconds + writing);
    estimate.bytes = rounded(scale * static_cast<double>(bytes));
    estimate.memoryBytes =
        memory + rounded(kCopies * scale * static_cast<double>(bytesOf(sample.items)));
    return estimate;
}

void report(const BakeEstimate& estimate, const std::filesystem::path& stats) {
    std::printf(
        "estimate from %s of the voxels: spacing %g, level %d: %llu items, %.1f M rays, "
        "%.1f M of them to emitters (%llu), %.0f s, %.1f MB, %.2f GB of memory\n",
        percentText(estimate.sampled, 3).c_str(), estimate.spacing, estimate.level,
        static_cast<unsigned long long>(estimate.items), static_cast<double>(estimate.rays) * 1e-6,
        static_cast<double>(estimate.emitterRays) * 1e-6,
        static_cast<unsigned long long>(estimate.emitters), estimate.seconds,
        static_cast<double>(estimate.bytes) * 1e-6,
        static_cast<double>(estimate.memoryBytes) * 1e-9);
    if (stats.empty()) return;
    JsonFile out;
    out.set("estimate.sampled", estimate.sampled);
    out.set("estimate.items", estimate.items);
    out.set("estimate.rays", estimate.rays);
    out.set("estimate.emitters", estimate.emitters);
    out.set("estimate.emitter_rays", estimate.emitterRays);
    out.set("estimate.seconds", estimate.seconds);
    out.set("estimate.bytes", estimate.bytes);
    out.set("estimate.memory_bytes", estimate.memoryBytes);
    out.set("cache.spacing", estimate.spacing);
    out.set("cache.level", static_cast<std::uint64_t>(estimate.level));
    out.write(stats);
}

}  // namespace shadowcache
