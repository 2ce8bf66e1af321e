#include "render/app/command_line.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <string_view>
#include <vector>

#include "common/cli/command_line.h"
#include "render/library/option_table.h"

namespace shadowcache {

namespace {

using std::string_view_literals::operator""sv;

/// CLI11 would require these with --list and --serve, too.
void requireWhatRendersNeed(const RenderJob& job) {
    if (job.run.output.empty()) throw CLI::RequiredError("--output");
    if (job.camera.name.empty() && !job.camera.eye)
        throw CLI::RequiredError("--camera, or --eye with --look-at,");
}

/// Requests say all that a run takes.
void requireNothingElse(const CLI::App& app) {
    for (const CLI::Option* option : app.get_options())
        if (option->count() > 0 && !option->check_lname("serve") && !option->check_lname("threads"))
            throw CLI::ExcludesError("--serve", option->get_name());
}

constexpr const char* kExamples =
    "Examples:\n"
    "  shadowcache-render room.obj --env sky.exr --cache room.vdb --eye 1,1.6,3 --look-at "
    "0,1,0 -o still.exr --png\n"
    "  shadowcache-render set.ply --env sun.hdr --cache set.vdb --camera move.json --frames "
    "1-24 -o shot.####.exr\n"
    "  shadowcache-render set.glb --env sky.####.exr --cache set.vdb --camera shot --frames "
    "1-240 --resume -o shot.####.exr\n"
    "  shadowcache-render set.glb --env sky.exr --bake set.vdb --camera shot -o still.exr\n"
    "  shadowcache-render set.ply --env 1,1,1 --eye 1,1,1 --look-at 0,0,0 --spp 256 "
    "-o a.exr\n"
    "  shadowcache-render --config shot.toml --explain";

}  // namespace

std::optional<int> parseArguments(int argc, char** argv, RenderJob& job) {
    CLI::App app(
        "Renders a static set lit by an environment map, without bias, with fewer rays where a "
        "cache "
        "predicts the visibility and the light that bounces.",
        "shadowcache-render");
    beginCommandLine(app);
    std::vector<std::string> groups{"Options", "Settings file"};
    groups.insert(groups.end(), std::begin(kShortHelp), std::end(kShortHelp));
    showInHelp(app, groups);
    std::vector<OptionRow> rows = optionRows(job);
    // Its requests name the set.
    if (std::any_of(argv, argv + argc, [](const char* word) { return "--serve"sv == word; }))
        rows.front().isRequired = false;
    app.footer(kExamples);
    const auto check = [&] {
        if (job.run.serve) return requireNothingElse(app);
        if (!job.run.list) requireWhatRendersNeed(job);
    };
    if (const auto status = parseCommandLine(app, argc, argv, rows, check)) return status;
    job.run.settings = settingsOf(app);
    // Pictures are those of the cache, whoever bakes it.
    for (auto& [name, value] : job.run.settings)
        if (name == "bake") name = "cache";
    return std::nullopt;
}

}  // namespace shadowcache
