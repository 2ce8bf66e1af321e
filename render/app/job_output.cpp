#include "render/app/job_output.h"

#include <set>
#include <vector>

#include "common/base/atomic_file.h"
#include "common/base/error.h"
#include "common/base/json_file.h"
#include "common/base/leftovers.h"
#include "common/base/option_checks.h"
#include "common/base/process.h"
#include "common/base/processor.h"
#include "common/base/version.h"
#include "common/image/exr.h"
#include "common/image/png.h"
#include "common/mesh/placed_mesh.h"
#include "common/shot/frames.h"
#include "render/app/frame_metadata.h"
#include "render/app/memory_report.h"
#include "render/frame/aov_channels.h"
#include "render/frame/aov_pictures.h"

namespace shadowcache {

std::filesystem::path frameFile(const RenderJob& job, int frame) {
    return framePath(job.run.output, frame,
                     job.run.frames.size() > 1 ? FrameNames::several
                     : job.run.framesGiven     ? FrameNames::one
                                               : FrameNames::unasked);
}

std::filesystem::path outputName(const RenderJob& job) {
    return job.run.frames.size() == 1 ? frameFile(job, job.run.frames.front()) : job.run.output;
}

std::vector<std::filesystem::path> frameFiles(const RenderJob& job, int frame) {
    std::vector<std::filesystem::path> files{frameFile(job, frame)};
    if (!job.run.png) return files;
    auto png = files.front();
    files.push_back(png.replace_extension(".png"));
    for (const auto& [aov, picture] : aovPictures(png, job.picture.aovs)) files.push_back(picture);
    return files;
}

void validateOutputs(const RenderJob& job) {
    requireExtension(job.run.output, ".exr");
    for (const int frame : job.run.frames) frameFiles(job, frame);
    if (!job.run.stats.empty()) requireExtension(job.run.stats, ".json");
}

void requireWritableOutputs(const RenderJob& job) {
    for (const int frame : job.run.frames)
        for (const auto& file : frameFiles(job, frame)) requireWritable(file);
    if (!job.run.stats.empty()) requireWritable(job.run.stats);
}

void refuseToOverwriteInputs(const RenderJob& job, const LightPlan& plan) {
    std::set<std::filesystem::path> inputs{job.run.reference};
    for (std::size_t i = 0; i < job.run.frames.size(); ++i)
        for (const auto& input : inputsOf(job, plan.at(i))) inputs.insert(input);
    std::set<std::filesystem::path> kept;
    for (const auto& input : inputs)
        if (std::error_code no; std::filesystem::exists(input, no))
            kept.insert(std::filesystem::canonical(input, no));
    const auto check = [&](const std::filesystem::path& output) {
        std::error_code no;
        if (kept.contains(std::filesystem::weakly_canonical(output, no)))
            throwFileError(output, "is an input of this run, expected another file to write");
    };
    for (const int frame : job.run.frames)
        for (const auto& file : frameFiles(job, frame)) check(file);
    check(job.run.stats);
}

void writeFrame(const RenderJob& job, const Film& film, Metadata metadata, const ExrView& view,
                const FrameProgress& progress, int frame) {
    const auto path = frameFile(job, frame);
    reportLeftovers(path);
    metadata.emplace_back("shadowcache:seconds", std::to_string(progress.seconds));
    metadata.emplace_back("shadowcache:processor", instructionSet());
    metadata.emplace_back("shadowcache:camera-rays-done", std::to_string(progress.cameraRays));
    if (!film.groups.empty())
        metadata.emplace_back("shadowcache:" + std::string(kGroupsKey), groupsText(film.groups));
    if (!progress.complete) metadata.emplace_back("shadowcache:incomplete", "true");
    writeExr(path, film.width, film.height,
             named(channels(film, job.picture.aovs), job.run.aovNames), metadata,
             job.run.half ? PixelType::half : PixelType::full,
             {film.x, film.y, film.frameWidth, film.frameHeight}, view);
    if (!job.run.png) return;
    auto png = path;
    writePng(png.replace_extension(".png"), colorImage(film), job.run.exposure, alphaOf(film));
    for (const auto& [aov, picture] : aovPictures(png, job.picture.aovs))
        writePng(picture, falseColorImage(film, aov), 0);
}

void writeStats(const RenderJob& job, const PictureSettings& settings, const TriangleMesh& mesh,
                const ShadowCache* cache, const Timing& timing, const RenderStats& stats,
                const std::optional<RelativeError>& error) {
    JsonFile out;
    out.set("version", std::string(kVersion));
    out.set("estimator", std::string(settings.estimator.name));
    out.set("bias", biasOf(settings));
    out.set("triangles", std::uint64_t{mesh.triangles.size()});
    const Box3d bounds = placedBounds(mesh);
    const Vec3d least = bounds.min + mesh.origin, most = bounds.max + mesh.origin;
    out.set("bounds.min", std::vector<double>{least.x, least.y, least.z});
    out.set("bounds.max", std::vector<double>{most.x, most.y, most.z});
    out.set("seconds.load", timing.load);
    out.set("seconds.build", timing.build);
    // Set-up and tracing are kept per thread; the rest is the camera's rays and the film.
    out.set("seconds.render", stats.seconds);
    out.set("seconds.setup", stats.setupSeconds);
    out.set("seconds.trace", stats.traceSeconds);
    out.set("rays.camera", stats.cameraRays);
    out.set("rays.camera_pilot", stats.spreadRays);
    out.set("rays.emission", stats.emissionRays);
    if (cache) out.set("rays.without_items", stats.raysWithoutItems);
    out.set("rays.shadow", stats.shadowRays);
    out.set("rays.own", stats.shadowRays - stats.reusedRays);
    out.set("rays.reused", stats.reusedRays);
    out.set("rays.bounces", stats.bounces.rays());
    out.set("bounces.vertices", stats.bounces.vertices);
    out.set("cache.items", std::uint64_t{cache ? cache->itemCount() : 0});
    out.set("cache.bytes", std::uint64_t{cache ? cache->memoryBytes() : 0});
    if (cache) addMemoryUse(out, cache->memoryUse());
    out.set("samples", static_cast<std::uint64_t>(stats.samples));
    out.set("camera_rays_a_pixel", stats.cameraRaysAPixel);
    out.set("error.by_own_variance", stats.ownError);
    if (error) {
        out.set("error.relmse", error->mean);
        out.set("error.l2", error->l2);
        out.set("error.p50", error->p50);
        out.set("error.p99", error->p99);
        out.set("error.max", error->max);
    }
    out.set("peak_rss_bytes", peakMemoryBytes());
    out.write(job.run.stats);
}

}  // namespace shadowcache
