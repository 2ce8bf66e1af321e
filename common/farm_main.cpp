#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <limits>
#include <string>
#include <vector>

#include "common/base/error.h"
#include "common/base/exit_status.h"
#include "common/base/option_checks.h"
#include "common/base/report_failure.h"
#include "common/base/run_rows.h"
#include "common/base/text_streams.h"
#include "common/cli/command_line.h"
#include "common/farm/farm_files.h"
#include "common/shot/camera_source.h"
#include "common/shot/frames.h"
#include "common/shot/set_options.h"

namespace shadowcache {
namespace {

struct Arguments {
    SetOptions set;
    CameraOptions camera;
    std::string frames;
    int width = 960, height = 540;
    std::vector<std::string> words;  ///< that bake and render have in common
    std::string pictures, bakeWith;
    const FarmScheduler* scheduler = nullptr;
    FarmJob job;
    std::filesystem::path folder;
    int threads = 0;
};

/// A row of an option that bake and render get as it was given.
OptionRow passedOn(OptionRow row, std::vector<std::string>& words) {
    row.group = "Shot";
    row.read = [read = row.read, name = row.isPositional ? "" : "--" + row.name,
                isFlag = row.form == OptionForm::flag, &words](std::span<const std::string> texts) {
        read(texts);
        for (const std::string& text : texts) {
            if (isFlag && text != "true") continue;
            if (!name.empty()) words.push_back(name);
            if (!isFlag) words.push_back(text);
        }
    };
    return row;
}

std::vector<OptionRow> optionRows(Arguments& a) {
    std::vector<OptionRow> rows;
    for (const OptionRow& row : setRows(a.set)) rows.push_back(passedOn(row, a.words));
    for (const OptionRow& row :
         {cameraRow(a.camera.name).required(), shutterRow(a.camera.shutter), fpsRow(a.set.fps),
          sizeRow(a.width, a.height), dynamicRow(a.set.dynamic)})
        rows.push_back(passedOn(row, a.words));
    rows.push_back(framesRow(a.frames).required());
    rows.back().group = "Shot";
    std::vector<std::string> schedulers;
    for (const FarmScheduler& scheduler : farmSchedulers()) schedulers.emplace_back(scheduler.name);
    OptionRow output = textRow("output", a.folder,
                               "Folder of the job, on a disk that all machines share, for scripts, "
                               "logs, the cache and the frames");
    output.letter = 'o';
    for (OptionRow& row : std::vector{
             wholeRow("bake-shards", a.job.shards, 1, kMostShards, "Tasks of the bake, 1 to 10000"),
             wholeRow("chunk", a.job.chunk, 1, std::numeric_limits<int>::max(), "Frames of a task"),
             threadsRow(a.threads),
             textRow("bake-with", a.bakeWith,
                     "Further options of shadowcache-bake, as in \"--spacing 0.1 --rays "
                     "32\"")}) {
        row.group = "Work";
        rows.push_back(std::move(row));
    }
    for (OptionRow& row :
         std::vector{option_row::word(
                         "for", [&a](std::size_t i) { a.scheduler = &farmSchedulers()[i]; },
                         schedulers, "What runs the job: a scheduler")
                         .required(),
                     output.required(),
                     textRow("pictures", a.pictures,
                             "EXR to write (.exr); #### or %04d becomes the frame number "
                             "[frames/frame.####.exr in the job's folder]")}) {
        row.group = "Output";
        rows.push_back(std::move(row));
    }
    return rows;
}

constexpr const char* kFooter =
    "Writes what a farm runs: what the shot looks up; a bake of that, in tasks; their merge; "
    "frames,\n"
    "in tasks; and a check that every frame is complete. What follows -- are options of "
    "shadowcache-render.\n\n"
    "Examples:\n"
    "  shadowcache-farm set.glb --camera shot_010 --frames 1-240 --bake-shards 8 --chunk 10 --for "
    "slurm -o job -- --env sky.exr --spp 64\n"
    "  job/submit --partition=render --time=2:00:00\n"
    "  shadowcache-farm room.ply --camera move.json --frames 1-24 --for parallel -o job -- --env "
    "sky.exr --spp 16\n"
    "  job/submit --jobs 4\n"
    "  job/run check   (any task by hand: job/run STEP TASK)";

/// Options of the programs that the plan sets.
constexpr const char* kOurs[] = {
    "--camera",   "--shutter", "--bake-spacing", "--frames",         "--shot-frames",  "--fps",
    "--size",     "--dynamic", "--cache",        "--allow-external", "--output",       "-o",
    "--check",    "--threads", "--up",           "--scale",          "--set-frame",    "--resume",
    "--list",     "--explain", "--debug",        "--stats",          "--write-config", "--shard",
    "--estimate", "--lookups", "--lookups-only", "--bake",           "--bake-quality", "--wait"};

void refuseOurOptions(const std::vector<std::string>& words, const char* where) {
    for (const std::string& word : words)
        for (const char* ours : kOurs)
            if (word == ours || word.starts_with(std::string(ours) + "="))
                throw Error(std::string(where) + " " + word +
                            ": set by shadowcache-farm itself, expected other options");
}

FarmJob jobOf(const Arguments& a, std::vector<std::string> forRenderer) {
    FarmJob job = a.job;
    meshOptionsOf(a.set);  // refuses what is out of range
    job.set = a.words;
    job.sources = a.set.files;
    if (a.camera.isFile()) job.sources.emplace_back(a.camera.name);
    TextReader words(a.bakeWith);
    for (std::string word; words >> word;) job.bakeOnly.push_back(word);
    refuseOurOptions(job.bakeOnly, "--bake-with");
    refuseOurOptions(forRenderer, "--");
    job.renderOnly = std::move(forRenderer);
    job.frames = parseFrames(a.frames);
    job.pictures = a.pictures;
    if (!a.pictures.empty()) {
        requireExtension(a.pictures, ".exr");
        framePath(a.pictures, 1, job.frames.size() > 1 ? FrameNames::several : FrameNames::one);
    }
    return job;
}

/// Folders of the programs that tasks run, joined by ':': this program's own, or those of a build.
/// Says which are in neither.
std::string programFolders() {
    namespace fs = std::filesystem;
    const fs::path own = fs::read_symlink("/proc/self/exe").parent_path();
    std::vector<fs::path> folders{own};
    for (const char* name : {"shadowcache-bake", "shadowcache-merge", "shadowcache-render"}) {
        std::error_code none;
        const auto has = [&](const fs::path& folder) { return fs::exists(folder / name, none); };
        if (std::ranges::any_of(folders, has)) continue;
        const fs::path built[] = {own.parent_path() / "bake", own.parent_path() / "render"};
        if (const auto* found = std::ranges::find_if(built, has); found != std::end(built))
            folders.push_back(*found);
        else
            std::fprintf(stderr,
                         "shadowcache-farm: warning: %s: not in %s; tasks look for it in "
                         "$SHADOWCACHE_BIN and on the PATH of their machines\n",
                         name, own.c_str());
    }
    std::string text;
    for (const fs::path& folder : folders) {
        if (!text.empty()) text += ':';
        text += folder.string();
    }
    return text;
}

void run(const Arguments& a, std::vector<std::string> forRenderer) {
    FarmPlan place;
    // Without a slash at the end, and through no link.
    place.folder = std::filesystem::weakly_canonical(std::filesystem::absolute(a.folder) / ".");
    place.work = std::filesystem::current_path();
    place.programs = programFolders();
    place.threads = a.threads;
    const FarmPlan plan = makePlan(jobOf(a, std::move(forRenderer)), place);
    writeFarm(plan, *a.scheduler);
    for (const FarmStep& step : plan.steps)
        std::printf("%s: %zu task%s\n", step.name.c_str(), step.values.size(),
                    step.values.size() == 1 ? "" : "s");
    std::printf("-> %s: %s\n", a.folder.c_str(), a.scheduler->submit);
}

}  // namespace
}  // namespace shadowcache

int main(int argc, char** argv) try {
    using namespace shadowcache;
    installFailureHandler();
    Arguments arguments;
    // What follows -- are no files of the set.
    char** const end = argv + argc;
    char** const separator = std::find(argv, end, std::string_view("--"));
    const ParsedLine parsed =
        parseCommandLine({"shadowcache-farm",
                          "Writes a job that bakes and renders a shot on many machines.", kFooter},
                         static_cast<int>(separator - argv), argv, optionRows(arguments));
    if (parsed.status) return *parsed.status;
    run(arguments, {separator == end ? end : separator + 1, end});
    return kDone;
} catch (const std::exception& e) {
    return shadowcache::reportFailure("shadowcache-farm", e);
}
