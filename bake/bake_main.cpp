#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <regex>
#include <string>
#include <vector>

#include "bake/core/baker.h"
#include "common/base/atomic_file.h"
#include "common/base/error.h"
#include "common/base/json_file.h"
#include "common/base/option_checks.h"
#include "common/base/parallel.h"
#include "common/base/process.h"
#include "common/base/progress.h"
#include "common/base/version.h"
#include "common/cli/command_line.h"
#include "common/import/load_mesh.h"
#include "common/import/mesh_options.h"

namespace shadowcache {
namespace {

struct Job {
    std::vector<std::filesystem::path> files;
    std::filesystem::path output;
    std::filesystem::path stats;
    MeshOptions mesh;
    BakeOptions bake;
    int threads = 0;
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

void defineOutput(CLI::App& app, Job& job) {
    const std::string group = "Output";
    app.add_option("-o,--output", job.output, "Cache to write (OpenVDB, .vdb)")
        ->required()
        ->group(group);
    app.add_option("--stats", job.stats, "Write times, rays and sizes as JSON")->group(group);
    addThreadsOption(app, job.threads, group);
}

constexpr const char* kFooter =
    "Stores which directions reach the sky, for every place near the set's surfaces.\n"
    "The cache does not depend on light or camera: bake once, render any shot under any map.\n\n"
    "Examples:\n"
    "  shadowcache-bake room.obj -o room.vdb\n"
    "  shadowcache-bake walls.ply trees.ply -o set.vdb --spacing 0.1 --rays 32\n"
    "  shadowcache-bake big.ply -o part2.vdb --shard 2/8   (then shadowcache-merge part*.vdb)";

/// When each stage was finished [s].
struct Times {
    double start, loaded, built, baked, written;
};

void writeStats(const Job& job, const TriangleMesh& mesh, const BakeResult& result,
                std::uintmax_t bytes, const Times& times) {
    JsonFile stats;
    stats.set("version", std::string(kVersion));
    stats.set("triangles", std::uint64_t{mesh.triangles.size()});
    stats.set("seconds.load", times.loaded - times.start);
    stats.set("seconds.build", times.built - times.loaded);
    stats.set("seconds.bake", times.baked - times.built);
    stats.set("seconds.write", times.written - times.baked);
    stats.set("rays.bake", result.rays);
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
    requireRange("threads", job.threads, 0, kMaxThreads);
    requireExtension(job.output, ".vdb");
    requireWritable(job.output);
    if (!job.stats.empty()) requireWritable(job.stats);
}

void run(const Job& job) {
    validate(job);
    setThreadCount(job.threads);
    installInterruptHandler();
    Times times{};
    times.start = secondsNow();
    const TriangleMesh mesh = loadMesh(job.files, job.mesh);
    std::printf("set: %s\n", describe(mesh.report).c_str());
    throwIfInterrupted();
    times.loaded = secondsNow();
    const Scene scene(mesh);
    times.built = secondsNow();
    BakeResult result = bake(scene, job.bake);
    result.header.upAxis = job.mesh.zUp ? "z" : "y";
    result.header.unit = job.mesh.scale;
    times.baked = secondsNow();
    const std::uintmax_t bytes = writeCache(job.output, result.header, result.items);
    times.written = secondsNow();

    std::printf(
        "spacing %g%s, level %d: %zu items, %zu blocks, %.1f M rays in %.1f s, %.1f MB -> %s\n",
        result.header.spacing, job.bake.spacing > 0 ? "" : " (chosen from the set's size)",
        result.header.level, result.items.size(), result.items.blocks.size(),
        static_cast<double>(result.rays) * 1e-6, times.baked - times.built,
        static_cast<double>(bytes) * 1e-6, job.output.c_str());
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
    beginCommandLine(app);
    addSetOptions(app, job.files, up, job.mesh.scale, "Set");
    defineBake(app, job, shard, uniform);
    defineOutput(app, job);
    app.footer(kFooter);
    if (const auto status = parseCommandLine(app, argc, argv)) return *status;
    job.bake.adaptive = !uniform;
    if (!shard.empty()) parseShard(shard, job.bake);
    job.mesh.zUp = up == "z";
    run(job);
    return 0;
} catch (const std::exception& e) {
    std::fprintf(stderr, "shadowcache-bake: %s\n", e.what());
    return 1;
}
