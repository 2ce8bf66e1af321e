#include <fmt/core.h>

#include <cstdio>
#include <optional>
#include <utility>

#include "bake/app/bake_task.h"
#include "bake/app/estimate.h"
#include "bake/app/job.h"
#include "bake/app/job_checkpoint.h"
#include "bake/app/job_identity.h"
#include "bake/core/cache_part.h"
#include "bake/core/emitter_recount.h"
#include "bake/core/extend.h"
#include "bake/library/bake_set.h"
#include "bake/shot/lookup_file.h"
#include "common/base/atomic_file.h"
#include "common/base/error.h"
#include "common/base/interrupt.h"
#include "common/base/json_file.h"
#include "common/base/leftovers.h"
#include "common/base/number_text.h"
#include "common/base/option_checks.h"
#include "common/base/parallel.h"
#include "common/base/process.h"
#include "common/base/version.h"
#include "common/cache/stored_bytes.h"
#include "common/import/load_mesh.h"

namespace shadowcache {

namespace {

/// Of the spacing that is chosen, as `--spacing 2x` has it.
constexpr double kLeastChosenSpacings = 0.01, kMostChosenSpacings = 1000;

/// When each stage was finished [s].
struct Times {
    double start, loaded, built, selected, baked, written;
};

/// Statistics common to all runs.
void beginStats(JsonFile& stats, const TriangleMesh& mesh, const Times& times) {
    stats.set("version", std::string(kVersion));
    stats.set("triangles", std::uint64_t{mesh.triangles.size()});
    stats.set("seconds.load", times.loaded - times.start);
    stats.set("seconds.build", times.built - times.loaded);
    stats.set("seconds.select", times.selected - times.built);
}

void writeStats(const BakeJob& job, const TriangleMesh& mesh, const BakeResult& result,
                std::uintmax_t bytes, const Times& times) {
    JsonFile stats;
    beginStats(stats, mesh, times);
    stats.set("seconds.bake", times.baked - times.selected);
    stats.set("seconds.write", times.written - times.baked);
    stats.set("rays.bake", result.rays);
    stats.set("rays.emitters", result.emitterRays);
    if (const auto& part = result.header.part) {
        stats.set("cache.sides", part->sides);
        stats.set("cache.sides_of_set", part->sidesOfSet);
    }
    stats.set("cache.items", std::uint64_t{result.items.size()});
    stats.set("cache.blocks", std::uint64_t{result.items.blocks.size()});
    stats.set("cache.emitters", std::uint64_t{result.header.emitters.size()});
    stats.set("cache.bytes", std::uint64_t{bytes});
    stats.set("cache.emitter_bytes", storedBytes(job.output).emitters);
    stats.set("cache.spacing", result.header.spacing);
    stats.set("cache.level", static_cast<std::uint64_t>(result.header.level));
    stats.set("peak_rss_bytes", peakMemoryBytes());
    stats.write(job.stats);
}

}  // namespace

void validate(const BakeJob& job) {
    validate(job.bake);
    validate(job.shot);
    const double times = job.chosenSpacings.value_or(1);
    if (!(times >= kLeastChosenSpacings && times <= kMostChosenSpacings))
        throw Error(fmt::format("--spacing {}x: expected {}x to {}x", numberText(times),
                                kLeastChosenSpacings, kMostChosenSpacings));
    requireRange("threads", job.threads, 0, kMaxThreads);
    requireRange("checkpoint", job.checkpointSeconds, 0.01, 60.0);
    if (!job.stats.empty()) {
        requireExtension(job.stats, ".json");
        requireWritable(job.stats);
    }
    if (job.estimate) return;
    requireExtension(job.output, job.lookupsOnly ? ".lookups" : ".vdb");
    requireWritable(job.output);
}

namespace {

/// Where the spacing is from, for the report.
const char* howChosen(const BakeJob& job) {
    if (job.bake.spacing > 0 || !job.extend.empty()) return "";
    return isSpacingFree(job) && !job.shot.camera.name.empty()
               ? " (chosen from the set's size and the shot)"
               : " (chosen from the set's size)";
}

/// Counts emitters for the items of the cache that the job extends, if it was baked without.
///
/// @return rays traced
std::uint64_t addEmitters(const BakeJob& job, const Scene& scene, BakeTask& task) {
    if (!task.old) return 0;
    const CacheHeader wanted = headerOf(scene.mesh(), task.options);
    if (!lacksEmitters(*task.old, wanted)) return 0;
    const std::uint64_t rays =
        recountEmitters(scene, task.options, task.frame, job.extend, task.old->items);
    std::printf("%s: emitters (%zu) counted for its %zu items, by %.1f M rays\n",
                job.extend.c_str(), wanted.emitters.size(), task.old->items.size(),
                static_cast<double>(rays) * 1e-6);
    return rays;
}

/// Bakes what the job asks for and the cache that it extends does not hold.
BakeResult bakeTask(const BakeJob& job, const std::optional<ShotSource>& shot, const Scene& scene,
                    BakeTask& task, Checkpoint& checkpoint, PartialCache* partial) {
    const PartialCache::Source source(
        partial, partial ? headerOf(scene.mesh(), task.options) : CacheHeader(), checkpoint);
    const std::uint64_t emitterRays = addEmitters(job, scene, task);
    BakeResult result = bakeOrKeep(scene, task.options, task.selection, checkpoint);
    result.rays += emitterRays;
    result.emitterRays += emitterRays;
    recordFiles(job.mesh, result.header);
    const std::size_t baked = result.items.size();
    if (shot) {
        const std::size_t sides = countSides(result.items),
                          ofSet = task.countOfSet(scene.mesh()).sides;
        if (!job.lookups.empty() && sides > ofSet)
            throwFileError(job.lookups,
                           fmt::format("{} sides of the set, expected {} or more", ofSet, sides));
        result.header.part = CachePart{sides, ofSet, shot->text()};
    }
    if (task.old) {
        addCache(*task.old, result);
        std::printf("%s: %zu items, %zu more baked\n", job.extend.c_str(), task.old->items.size(),
                    baked);
    }
    return result;
}

/// Writes what the shot looks up.
void finishLookups(const BakeJob& job, const TriangleMesh& mesh, BakeTask& task,
                   const BakeIdentity& identity, const Times& times) {
    const ShotLookups lookups{task.options.spacing, task.options.level, task.countOfSet(mesh),
                              std::move(*task.selection.lookups)};
    writeLookups(job.output, identityOfLookups(job, identity), lookups);
    const std::size_t places = lookups.places.places().size();
    std::printf("spacing %g: %zu places that the shot looks up, in %.1f s -> %s\n", lookups.spacing,
                places, times.selected - times.built, job.output.c_str());
    if (job.stats.empty()) return;
    JsonFile stats;
    beginStats(stats, mesh, times);
    stats.set("lookups.places", std::uint64_t{places});
    stats.set("peak_rss_bytes", peakMemoryBytes());
    stats.write(job.stats);
}

}  // namespace

void run(const BakeJob& job, const BakeCompany& company) {
    validate(job);
    setThreadCount(job.threads);
    installInterruptHandler();
    Times times{};
    times.start = secondsNow();
    if (!job.estimate) reportLeftovers(job.output);
    if (!job.extend.empty())
        readHeader(job.extend);  // refuses what is no cache before it is hashed
    BakeIdentity identity;
    if (!job.estimate || !job.lookups.empty()) identity = identityOf(job);
    std::optional<ShotLookups> found;
    if (!job.lookups.empty()) found = readLookups(job.lookups, identityOfLookups(job, identity));
    const auto checkpoint =
        job.estimate || job.lookupsOnly ? nullptr : startCheckpoint(job, identity);
    std::optional<ShotSource> shot;
    if (!job.shot.camera.name.empty()) shot.emplace(job.shot, job.files, job.mesh);
    std::optional<TriangleMesh> read;
    if (!company.mesh) {
        read.emplace(loadMesh(job.files, job.mesh));
        std::printf("set: %s\n", describe(read->report).c_str());
    }
    const TriangleMesh& mesh = company.mesh ? *company.mesh : *read;
    throwIfInterrupted();
    times.loaded = secondsNow();
    Scene scene(mesh);
    times.built = secondsNow();
    BakeTask task(job, shot, scene, found);
    times.selected = secondsNow();
    if (job.lookupsOnly) return finishLookups(job, scene.mesh(), task, identity, times);
    if (job.estimate) {
        const BakeEstimate estimate =
            estimateBake(scene, task.options, task.selection, times.selected - times.start);
        report(estimate, job.stats);
        return;
    }
    const BakeResult result = bakeTask(job, shot, scene, task, *checkpoint, company.partial);
    times.baked = secondsNow();
    const std::uintmax_t bytes = writeCache(job.output, result.header, result.items);
    checkpoint->remove();
    times.written = secondsNow();

    std::printf(
        "spacing %g%s, level %d: %zu items, %zu blocks, %.1f M rays in %.1f s, %.1f MB -> %s\n",
        result.header.spacing, howChosen(job), result.header.level, result.items.size(),
        result.items.blocks.size(), static_cast<double>(result.rays) * 1e-6,
        times.baked - times.built, static_cast<double>(bytes) * 1e-6, job.output.c_str());
    if (const auto& part = result.header.part)
        std::printf(
            "part of the set: %.1f %% of its surface (%llu of %llu sides of voxels), for %s\n",
            100 * static_cast<double>(part->sides) / static_cast<double>(part->sidesOfSet),
            static_cast<unsigned long long>(part->sides),
            static_cast<unsigned long long>(part->sidesOfSet), part->shots.c_str());
    if (!job.stats.empty()) writeStats(job, mesh, result, bytes, times);
}

}  // namespace shadowcache
