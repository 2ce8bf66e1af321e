#include "bake/app/command_line.h"

#include "bake/library/bake_rows.h"
#include "common/base/option_text.h"
#include "common/base/run_rows.h"
#include "common/cli/command_line.h"
#include "common/shot/set_options.h"

namespace shadowcache {

namespace {

using Rows = std::vector<OptionRow>;

void add(Rows& rows, const char* group, std::vector<OptionRow> more) {
    for (OptionRow& row : more) {
        row.group = group;
        rows.push_back(std::move(row));
    }
}

Rows shotRows(BakeJob& job) {
    ShotOptions& shot = job.shot;
    Rows rows{shutterRow(shot.camera.shutter),
              framesRow(shot.frames),
              fpsRow(shot.fps),
              sizeRow(shot.size[0], shot.size[1]),
              dynamicRow(shot.dynamic),
              marginRow(shot.margin),
              flagRow("lookups-only", job.lookupsOnly,
                      "Write what the pictures look up to OUTPUT (.lookups), and no cache")
                  .notKept(),
              textRow("lookups", job.lookups,
                      "Take what the pictures look up from this file of --lookups-only, in place "
                      "of finding it; it must be of the same set, camera, frames, size and spacing")
                  .excluding("lookups-only")};
    for (OptionRow& row : rows) {
        row.needing("camera");
        if (row.name != "size" && row.name != "margin") row.onlyAt({Door::commandLine});
    }
    rows.insert(rows.begin(), cameraRow(shot.camera.name).onlyAt({Door::commandLine}));
    rows.push_back(textRow("extend", job.extend,
                           "Add to this cache, without baking again what it holds; it must be of "
                           "the same set, options and seed")
                       .onlyAt({Door::commandLine}));
    return rows;
}

OptionRow memoryRow(std::uint64_t& bytes) {
    return ownRow(
               "memory", OptionForm::text,
               [&bytes](const std::string& text) { bytes = bytesOf("memory", text); },
               "Most finished items that stay in memory until the end, as in 4G; more are read "
               "back from the checkpoint")
        .typed("TEXT");
}

Rows outputRows(BakeJob& job) {
    OptionRow output = textRow("output", job.output, "Cache to write (OpenVDB, .vdb)");
    output.letter = 'o';
    Rows rows{
        output,
        flagRow("estimate", job.estimate,
                "Bake a sample of the voxels and print what the whole would take: items, rays, "
                "seconds, bytes, memory; write no cache")
            .excluding("lookups-only")
            .notKept(),
        textRow("stats", job.stats, "Write times, rays and sizes as JSON"),
        flagRow("resume", job.resume,
                "Continue where an interrupted bake of the same set and options stopped, from "
                "the folder OUTPUT.checkpoint"),
        numberRow("checkpoint", job.checkpointSeconds, {0.01, 60},
                  "Seconds between two checkpoints, 0.01 to 60"),
        memoryRow(job.memory),
        threadsRow(job.threads),
        progressRow()};
    for (OptionRow& row : rows) row.onlyAt({Door::commandLine});
    return rows;
}

Rows optionRows(BakeJob& job, SetOptions& set) {
    Rows rows;
    add(rows, "Set", setRows(set));
    add(rows, "Bake", bakeRows(job.bake, job.chosenSpacings));
    add(rows, "Shot: bake only what its pictures look up", shotRows(job));
    add(rows, "Output", outputRows(job));
    return rows;
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
    SetOptions set;
    const std::vector<OptionRow> rows = optionRows(job, set);
    const auto check = [&](const ParsedLine&) {
        if (job.output.empty() && !job.estimate) throw FormError("--output is required");
    };
    ParsedLine parsed = parseCommandLine(
        {"shadowcache-bake", "Bakes the visibility of a static set into a sparse OpenVDB file.",
         kFooter},
        argc, argv, rows, check);
    if (parsed.status) return parsed.status;
    set.fps = job.shot.fps;
    job.files = set.files;
    job.mesh = meshOptionsOf(set);
    job.mesh.gloss = true;  // has what emits
    job.isLevelGiven = parsed.isGiven("--level");
    job.settings = std::move(parsed.settings);
    return std::nullopt;
}

}  // namespace shadowcache
