#include "bake/app/command_line.h"

#include <CLI/CLI.hpp>

#include "common/base/error.h"
#include "common/base/take_text.h"
#include "common/cli/command_line.h"
#include "common/cli/options.h"
#include "common/command/shot_arguments.h"

namespace shadowcache {

namespace {

/// "K/N" -> shard K - 1 of N.
void parseShard(const std::string& text, BakeOptions& options) {
    std::string_view rest = text;
    int part = 0;
    if (takeNumber(rest, part) && takeCharacter(rest, '/') && takeNumber(rest, options.shards) &&
        rest.empty() && part >= 0 && options.shards >= 0) {
        options.shard = part - 1;
        return;
    }
    throw Error("--shard " + text + ": expected K/N, as in 2/8");
}

/// Metres, or "2x": times the spacing that is chosen.
void parseSpacing(const std::string& text, BakeJob& job) {
    std::string_view rest = text;
    double number = 0;
    if (takeNumber(rest, number)) {
        const bool isRelative = takeCharacter(rest, 'x');
        if (isRelative)
            job.chosenSpacings = number;
        else
            job.bake.spacing = number;
        if (rest.empty()) return;
    }
    throw Error("--spacing " + text +
                ": expected metres, or times the spacing that is chosen, as in 2x");
}

/// Options that are parsed after the command line.
struct BakeWords {
    std::optional<std::string> spacing;
    std::string shard;
    bool uniform = false, noTransport = false;
};

void defineBake(CLI::App& app, BakeJob& job, BakeWords& words) {
    const std::string group = "Bake";
    app.add_option("--spacing", words.spacing,
                   "Voxel size in metres; smaller is sharper, at a cost of the inverse square. 2x: "
                   "twice the one that is chosen [chosen from the set's size]")
        ->type_name("METRES")
        ->group(group);
    app.add_option("--level", job.bake.level,
                   "Finest direction level, 0 to 5: 20 * 4^level regions over the sphere")
        ->capture_default_str()
        ->group(group);
    app.add_option("--rays", job.bake.rays, "Rays per region of mixed visibility, 1 to 255")
        ->capture_default_str()
        ->group(group);
    // No negated flag: CLI11 would write it to a settings file the wrong way round.
    app.add_flag("--uniform", words.uniform,
                 "Refine every region to the finest level, not only where visibility is mixed")
        ->group(group);
    app.add_flag("--no-transport", words.noTransport,
                 "Leave out which items the rays of each item met, which bounced light uses")
        ->group(group);
    addSeedOption(app, job.bake.seed,
                  "Random seed; caches of different seeds merge into a better one")
        ->group(group);
    app.add_option("--shard", words.shard,
                   "Bake part K of N of the set; shadowcache-merge joins the parts")
        ->group(group);
}

void defineShot(CLI::App& app, BakeJob& job, ShotArguments& shot) {
    const std::string group = "Shot: bake only what its pictures look up";
    addShotOptions(app, shot, group, group);
    auto* camera = app.get_option("--camera");
    for (const char* name : {"--shutter", "--frames", "--fps", "--size", "--dynamic"})
        app.get_option(name)->needs(camera);
    app.get_option("--frames")->default_str(job.shot.frames);
    app.add_option("--margin", job.shot.margin,
                   "Voxels to bake around those that are looked up, 0 to 64, for cameras that may "
                   "still move")
        ->needs(camera)
        ->capture_default_str()
        ->group(group);
    auto* only = app.add_flag("--lookups-only", job.lookupsOnly,
                              "Write what the pictures look up to OUTPUT (.lookups), and no cache")
                     ->configurable(false)
                     ->needs(camera)
                     ->group(group);
    app.add_option("--lookups", job.lookups,
                   "Take what the pictures look up from this file of --lookups-only, in place of "
                   "finding it; it must be of the same set, camera, frames, size and spacing")
        ->needs(camera)
        ->excludes(only)
        ->group(group);
    app.add_option("--extend", job.extend,
                   "Add to this cache, without baking again what it holds; it must be of the same "
                   "set, options and seed")
        ->group(group);
}

void defineOutput(CLI::App& app, BakeJob& job, std::string& memory) {
    const std::string group = "Output";
    app.add_option("-o,--output", job.output, "Cache to write (OpenVDB, .vdb)")->group(group);
    app.add_flag("--estimate", job.estimate,
                 "Bake a sample of the voxels and print what the whole would take: items, rays, "
                 "seconds, bytes, memory; write no cache")
        ->excludes("--lookups-only")
        ->configurable(false)
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
    app.add_option("--memory", memory,
                   "Most finished items that stay in memory until the end, as in 4G; more are read "
                   "back from the checkpoint")
        ->group(group);
    addThreadsOption(app, job.threads, group);
    addProgressOption(app, group);
}

constexpr const char* kFooter =
    "Stores which directions reach the sky, for every place near the set's surfaces.\n"
    "The cache does not depend on light or camera: bake once, render any shot under any map.\n\n"
    "Examples:\n"
    "  shadowcache-bake room.obj -o room.vdb\n"
    "  shadowcache-bake room.obj --estimate\n"
    "  shadowcache-bake walls.ply trees.ply -o set.vdb --spacing 0.1 --rays 32\n"
    "  shadowcache-bake set.glb -o shot.vdb --camera shot_010 --frames 1-96\n"
    "  shadowcache-bake set.glb -o shot.vdb --extend shot.vdb --camera shot_020 --frames 1-48\n"
    "  shadowcache-bake big.ply -o part2.vdb --shard 2/8   (then shadowcache-merge part*.vdb)\n"
    "  shadowcache-bake set.glb -o shot.lookups --lookups-only --camera shot_010 --frames 1-96\n"
    "  shadowcache-bake set.glb -o part2.vdb --shard 2/8 --lookups shot.lookups --camera shot_010 "
    "--frames 1-96";

}  // namespace

std::optional<int> parseArguments(int argc, char** argv, BakeJob& job) {
    CLI::App app("Bakes the visibility of a static set into a sparse OpenVDB file.",
                 "shadowcache-bake");
    BakeWords words;
    std::string memory;
    ShotArguments shot;
    beginCommandLine(app);
    addSetOptions(app, shot, "Set", "Set");
    defineBake(app, job, words);
    defineShot(app, job, shot);
    defineOutput(app, job, memory);
    app.footer(kFooter);
    const auto check = [&] {
        if (job.output.empty() && !job.estimate) throw CLI::RequiredError("--output");
    };
    if (const auto status = parseCommandLine(app, argc, argv, check)) return status;
    job.bake.adaptive = !words.uniform;
    job.bake.transport = !words.noTransport;
    if (words.spacing) parseSpacing(*words.spacing, job);
    if (!words.shard.empty()) parseShard(words.shard, job.bake);
    job.files = shot.files;
    job.mesh = meshOptionsOf(shot, job.mesh);
    job.shot.camera.name = shot.camera;
    if (!shot.frames.empty()) job.shot.frames = shot.frames;
    job.shot.camera.shutter = shot.shutter;
    job.shot.fps = shot.fps;
    job.shot.size = sizeOf(shot);
    job.shot.dynamic = dynamicFilesOf(shot);
    if (!memory.empty()) job.memory = parseSize("--memory", memory);
    job.settings = settingsOf(app);
    return std::nullopt;
}

}  // namespace shadowcache
