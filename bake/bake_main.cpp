#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <optional>
#include <regex>
#include <string>
#include <string_view>
#include <vector>

#include "bake/core/cache_part.h"
#include "bake/core/extend.h"
#include "bake/core/surface_count.h"
#include "bake/shot/shot_source.h"
#include "common/base/atomic_file.h"
#include "common/base/error.h"
#include "common/base/exit_status.h"
#include "common/base/interrupt.h"
#include "common/base/json_file.h"
#include "common/base/leftovers.h"
#include "common/base/option_checks.h"
#include "common/base/parallel.h"
#include "common/base/process.h"
#include "common/base/report_failure.h"
#include "common/base/version.h"
#include "common/cli/command_line.h"
#include "common/import/load_mesh.h"
#include "common/import/mesh_options.h"
#include "common/import/set_files.h"

namespace shadowcache {
namespace {

/// Options that items do not depend on, or that identityOf() states by content.
constexpr std::string_view kNotOfTheItems[] = {"SET",     "output",  "stats",      "threads",
                                               "resume",  "extend",  "checkpoint", "camera",
                                               "dynamic", "progress"};

struct Job {
    std::vector<std::filesystem::path> files;
    std::filesystem::path output;
    std::filesystem::path stats;
    std::filesystem::path extend;  ///< cache to add to; empty: none
    MeshOptions mesh;
    BakeOptions bake;
    ShotOptions shot;  ///< without a camera: the bake is of the whole set
    int threads = 0;
    bool resume = false;
    double checkpointSeconds = 30;
    std::vector<std::pair<std::string, std::string>> settings;  ///< as settingsOf() has them
};

/// The shot's options as the command line has them.
struct ShotArguments {
    std::string size = "960x540";
    std::vector<std::string> dynamic;
};

/// "K/N" -> shard K - 1 of N.
void parseShard(const std::string& text, BakeOptions& options) {
    static const std::regex wanted(R"((\d{1,8})/(\d{1,8}))");
    std::smatch match;
    if (!std::regex_match(text, match, wanted))
        throw Error("--shard " + text + ": expected K/N, as in 2/8");
    options.shard = std::stoi(match[1]) - 1;
    options.shards = std::stoi(match[2]);
}

void defineBake(CLI::App& app, Job& job, std::string& shard, bool& uniform) {
    const std::string group = "Bake";
    app.add_option("--spacing", job.bake.spacing,
                   "Voxel size in metres; smaller is sharper, at a cost of the inverse square "
                   "[chosen from the set's size]")
        ->group(group);
    app.add_option("--level", job.bake.level,
                   "Finest direction level, 0 to 5: 20 * 4^level regions over the sphere")
        ->capture_default_str()
        ->group(group);
    app.add_option("--rays", job.bake.rays, "Rays per region of mixed visibility, 1 to 255")
        ->capture_default_str()
        ->group(group);
    // No negated flag: CLI11 would write it to a settings file the wrong way round.
    app.add_flag("--uniform", uniform,
                 "Refine every region to the finest level, not only where visibility is mixed")
        ->group(group);
    app.add_option("--seed", job.bake.seed,
                   "Random seed; caches of different seeds merge into a better one")
        ->check(notNegative)
        ->capture_default_str()
        ->group(group);
    app.add_option("--shard", shard,
                   "Bake part K of N of the set; shadowcache-merge joins the parts")
        ->group(group);
}

void defineShot(CLI::App& app, Job& job, ShotArguments& shot) {
    const std::string group = "Shot";
    auto* camera = app.add_option("--camera", job.shot.camera.name,
                                  "Bake only what the pictures of this camera look up: a camera "
                                  "file (JSON), or the name of a camera in a glTF set")
                       ->group(group);
    app.add_option("--frames", job.shot.frames,
                   "Frames of the shot: A, A-B or A-BxSTEP, joined by commas")
        ->needs(camera)
        ->capture_default_str()
        ->group(group);
    app.add_option("--size", shot.size, "Size of its pictures in pixels: WxH")
        ->needs(camera)
        ->capture_default_str()
        ->group(group);
    app.add_option("--margin", job.shot.margin,
                   "Voxels to bake around those that are looked up, 0 to 64, for cameras that may "
                   "still move")
        ->needs(camera)
        ->capture_default_str()
        ->group(group);
    app.add_option("--fps", job.shot.fps, "Frames per second of a glTF set's animations")
        ->needs(camera)
        ->capture_default_str()
        ->group(group);
    app.add_option("--dynamic", shot.dynamic,
                   "FILE or FILE@TRACK.json: a moving object of the shot, as shadowcache-render "
                   "has it; not baked")
        ->take_all()
        ->allow_extra_args(false)
        ->needs(camera)
        ->group(group);
    app.add_option("--extend", job.extend,
                   "Add to this cache, without baking again what it holds; it must be of the same "
                   "set, options and seed")
        ->group(group);
}

void defineOutput(CLI::App& app, Job& job) {
    const std::string group = "Output";
    app.add_option("-o,--output", job.output, "Cache to write (OpenVDB, .vdb)")
        ->required()
        ->group(group);
    app.add_option("--stats", job.stats, "Write times, rays and sizes as JSON")->group(group);
    app.add_flag("--resume", job.resume,
                 "Continue where an interrupted bake of the same set and options stopped, from the "
                 "folder OUTPUT.checkpoint")
        ->group(group);
    app.add_option("--checkpoint", job.checkpointSeconds,
                   "Seconds between two checkpoints, 0.01 to 60")
        ->capture_default_str()
        ->group(group);
    addThreadsOption(app, job.threads, group);
    addProgressOption(app, group);
}

constexpr const char* kFooter =
    "Stores which directions reach the sky, for every place near the set's surfaces.\n"
    "The cache does not depend on light or camera: bake once, render any shot under any map.\n\n"
    "Examples:\n"
    "  shadowcache-bake room.obj -o room.vdb\n"
    "  shadowcache-bake walls.ply trees.ply -o set.vdb --spacing 0.1 --rays 32\n"
    "  shadowcache-bake set.glb -o shot.vdb --camera shot_010 --frames 1-96\n"
    "  shadowcache-bake set.glb -o shot.vdb --extend shot.vdb --camera shot_020 --frames 1-48\n"
    "  shadowcache-bake big.ply -o part2.vdb --shard 2/8   (then shadowcache-merge part*.vdb)";

/// When each stage was finished [s].
struct Times {
    double start, loaded, built, selected, baked, written;
};

void writeStats(const Job& job, const TriangleMesh& mesh, const BakeResult& result,
                std::uintmax_t bytes, const Times& times) {
    JsonFile stats;
    stats.set("version", std::string(kVersion));
    stats.set("triangles", std::uint64_t{mesh.triangles.size()});
    stats.set("seconds.load", times.loaded - times.start);
    stats.set("seconds.build", times.built - times.loaded);
    stats.set("seconds.select", times.selected - times.built);
    stats.set("seconds.bake", times.baked - times.selected);
    stats.set("seconds.write", times.written - times.baked);
    stats.set("rays.bake", result.rays);
    if (const auto& part = result.header.part) {
        stats.set("cache.sides", part->sides);
        stats.set("cache.sides_of_set", part->sidesOfSet);
    }
    stats.set("cache.items", std::uint64_t{result.items.size()});
    stats.set("cache.blocks", std::uint64_t{result.items.blocks.size()});
    stats.set("cache.bytes", std::uint64_t{bytes});
    stats.set("cache.spacing", result.header.spacing);
    stats.set("cache.level", static_cast<std::uint64_t>(result.header.level));
    stats.set("peak_rss_bytes", peakMemoryBytes());
    stats.write(job.stats);
}

/// Refuses invalid options before the long work starts.
void validate(const Job& job) {
    validate(job.bake);
    validate(job.shot);
    requireRange("threads", job.threads, 0, kMaxThreads);
    requireRange("checkpoint", job.checkpointSeconds, 0.01, 60.0);
    requireExtension(job.output, ".vdb");
    requireWritable(job.output);
    if (!job.stats.empty()) requireWritable(job.stats);
}

/// Chooses the spacing if the command line does not: that of the cache that is added to, or one for
/// the set's size.
///
/// @param count  receives the set's surface in voxels if it was counted
BakeOptions optionsOf(const Job& job, const TriangleMesh& mesh,
                      std::optional<SurfaceCount>& count) {
    BakeOptions options = job.bake;
    if (options.spacing > 0) return options;
    if (!job.extend.empty()) {
        options.spacing = readHeader(job.extend).spacing;
        return options;
    }
    options.spacing = chooseSpacing(mesh, &count.emplace());
    return options;
}

/// What the bake of a shot holds of the set.
std::optional<CachePart> partOf(const std::optional<ShotSource>& shot, const CacheItems& items,
                                const SurfaceCount& ofSet) {
    if (!shot) return std::nullopt;
    return CachePart{countSides(items), ofSet.sides, shot->text()};
}

/// All that the items of the job's cache depend on.
BakeIdentity identityOf(const Job& job) {
    BakeIdentity identity{{"version", kVersion}, {"set", contentHashOf(job.files)}};
    // Where things are read from and written to is no part of it; what is read is.
    for (const auto& [name, value] : job.settings)
        if (std::ranges::find(kNotOfTheItems, name) == std::end(kNotOfTheItems))
            identity.emplace_back(name, value);
    const std::filesystem::path camera = job.shot.camera.name;
    identity.emplace_back("camera", camera.filename().string());
    std::vector<std::filesystem::path> moving{camera};
    for (const DynamicFile& file : job.shot.dynamic) {
        moving.push_back(file.mesh);
        moving.push_back(file.track);
    }
    identity.emplace_back("shot's files", contentHashOf(moving));
    identity.emplace_back("extended cache", contentHashOf(std::vector{job.extend}));
    return identity;
}

/// The checkpoint that the job continues, or starts.
Checkpoint openCheckpoint(const Job& job) {
    reportLeftovers(job.output);
    return {job.output, identityOf(job), job.checkpointSeconds};
}

/// Finds what earlier runs left in a checkpoint.
void beginCheckpoint(const Job& job, Checkpoint& checkpoint) {
    const char* folder = checkpoint.folder().c_str();
    if (job.resume) {
        if (const std::size_t regions = checkpoint.resume())
            std::printf("%s: %zu regions are finished\n", folder, regions);
    } else if (checkpoint.discardOthers() > 0) {
        std::printf("%s: removed what an interrupted bake had left (--resume would continue it)\n",
                    folder);
    }
}

/// bake(), which leaves its checkpoint behind if it is interrupted.
BakeResult bakeOrKeep(const Scene& scene, const BakeOptions& options,
                      const VoxelSelection& selection, Checkpoint& checkpoint) {
    try {
        return bake(scene, options, selection, &checkpoint);
    } catch (const Interrupted&) {
        if (checkpoint.flush() && checkpoint.regions() > 0)
            std::printf("%s: %zu regions are kept; the same command with --resume continues\n",
                        checkpoint.folder().c_str(), checkpoint.regions());
        throw;
    }
}

/// Bakes what the job asks for and the cache that it extends does not hold.
BakeResult bakeJob(const Job& job, const std::optional<ShotSource>& shot, Scene& scene,
                   Checkpoint& checkpoint, Times& times) {
    std::optional<SurfaceCount> count;
    const BakeOptions options = optionsOf(job, scene.mesh(), count);
    const VoxelFrame frame(scene.mesh(), options.spacing);
    std::optional<CacheToExtend> old;
    VoxelSelection selection;
    if (!job.extend.empty()) {
        old = readCacheToExtend(job.extend, headerOf(scene.mesh(), options));
        selection.present = VoxelSides(frame, old->items);
    }
    if (shot) {
        selection.lookups = shot->lookups(scene, frame);
        selection.margin = job.shot.margin;
    }
    times.selected = secondsNow();
    BakeResult result = bakeOrKeep(scene, options, selection, checkpoint);
    result.header.upAxis = job.mesh.zUp ? "z" : "y";
    result.header.unit = job.mesh.scale;
    const std::size_t baked = result.items.size();
    if (shot)
        result.header.part =
            partOf(shot, result.items, count ? *count : countSurface(scene.mesh(), frame));
    if (old) {
        addCache(*old, result);
        std::printf("%s: %zu items, %zu more baked\n", job.extend.c_str(), old->items.size(),
                    baked);
    }
    return result;
}

void run(const Job& job) {
    validate(job);
    setThreadCount(job.threads);
    installInterruptHandler();
    Times times{};
    times.start = secondsNow();
    Checkpoint checkpoint = openCheckpoint(job);
    beginCheckpoint(job, checkpoint);
    std::optional<ShotSource> shot;
    if (!job.shot.camera.name.empty()) shot.emplace(job.shot, job.files, job.mesh);
    const TriangleMesh mesh = loadMesh(job.files, job.mesh);
    std::printf("set: %s\n", describe(mesh.report).c_str());
    throwIfInterrupted();
    times.loaded = secondsNow();
    Scene scene(mesh);
    times.built = secondsNow();
    const BakeResult result = bakeJob(job, shot, scene, checkpoint, times);
    times.baked = secondsNow();
    const std::uintmax_t bytes = writeCache(job.output, result.header, result.items);
    checkpoint.remove();
    times.written = secondsNow();

    std::printf(
        "spacing %g%s, level %d: %zu items, %zu blocks, %.1f M rays in %.1f s, %.1f MB -> %s\n",
        result.header.spacing,
        job.bake.spacing > 0 || !job.extend.empty() ? "" : " (chosen from the set's size)",
        result.header.level, result.items.size(), result.items.blocks.size(),
        static_cast<double>(result.rays) * 1e-6, times.baked - times.built,
        static_cast<double>(bytes) * 1e-6, job.output.c_str());
    if (const auto& part = result.header.part)
        std::printf(
            "part of the set: %.1f %% of its surface (%llu of %llu sides of voxels), for %s\n",
            100 * static_cast<double>(part->sides) / static_cast<double>(part->sidesOfSet),
            static_cast<unsigned long long>(part->sides),
            static_cast<unsigned long long>(part->sidesOfSet), part->shots.c_str());
    if (!job.stats.empty()) writeStats(job, mesh, result, bytes, times);
}

}  // namespace
}  // namespace shadowcache

int main(int argc, char** argv) try {
    using namespace shadowcache;
    CLI::App app("Bakes the visibility of a static set into a sparse OpenVDB file.",
                 "shadowcache-bake");
    Job job;
    std::string up = "y", shard;
    bool uniform = false;
    ShotArguments shot;
    beginCommandLine(app);
    addSetOptions(app, job.files, up, job.mesh.scale, "Set");
    defineBake(app, job, shard, uniform);
    defineShot(app, job, shot);
    defineOutput(app, job);
    app.footer(kFooter);
    if (const auto status = parseCommandLine(app, argc, argv)) return *status;
    job.bake.adaptive = !uniform;
    if (!shard.empty()) parseShard(shard, job.bake);
    job.shot.size = parsePair("--size", shot.size, "WxH, as in 960x540");
    for (const std::string& text : shot.dynamic) job.shot.dynamic.push_back(parseDynamic(text));
    job.mesh.zUp = up == "z";
    job.settings = settingsOf(app);
    run(job);
    return kDone;
} catch (const std::exception& e) {
    return shadowcache::reportFailure("shadowcache-bake", e);
}
