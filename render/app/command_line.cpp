#include "render/app/command_line.h"

#include <algorithm>
#include <string_view>
#include <vector>

#include "common/cli/command_line.h"
#include "render/library/option_table.h"

namespace shadowcache {

namespace {

using std::string_view_literals::operator""sv;

/// All but --list and --serve need these.
void requireWhatRendersNeed(const RenderJob& job) {
    if (job.run.output.empty()) throw FormError("--output is required");
    if (job.camera.name.empty() && !job.camera.eye)
        throw FormError("--camera, or --eye with --look-at, is required");
}

/// Requests say all that a run takes.
void requireNothingElse(const ParsedLine& parsed) {
    for (const std::string& option : parsed.given)
        if (option != "--serve" && option != "--threads")
            throw FormError("--serve excludes " + option);
}

constexpr const char* kExamples =
    "Examples:\n"
    "  shadowcache-render room.obj --env sky.exr --cache room.vdb --eye 1,1.6,3 --look-at "
    "0,1,0 -o still.exr --png\n"
    "  shadowcache-render set.ply --env sun.hdr --cache set.vdb --camera move.json --frames "
    "1-24 -o shot.####.exr\n"
    "  shadowcache-render set.glb --env sky.####.exr --cache set.vdb --camera shot --frames "
    "1-240 --resume -o shot.####.exr\n"
    "  shadowcache-render set.ply --env 1,1,1 --eye 1,1,1 --look-at 0,0,0 --spp 256 "
    "-o a.exr\n"
    "  shadowcache-render --config shot.toml --explain";

}  // namespace

std::optional<int> parseArguments(int argc, char** argv, RenderJob& job) {
    std::vector<std::string> groups{"Options", "Settings file"};
    groups.insert(groups.end(), std::begin(kShortHelp), std::end(kShortHelp));
    std::vector<OptionRow> rows = optionRows(job);
    // Its requests name the set.
    if (std::any_of(argv, argv + argc, [](const char* word) { return "--serve"sv == word; }))
        rows.front().isRequired = false;
    const auto check = [&](const ParsedLine& parsed) {
        if (job.run.serve) return requireNothingElse(parsed);
        if (!job.run.list) requireWhatRendersNeed(job);
    };
    ParsedLine parsed = parseCommandLine(
        {"shadowcache-render",
         "Renders a static set lit by an environment map, without bias, with fewer rays where a "
         "cache predicts the visibility and the light that bounces.",
         kExamples, std::move(groups)},
        argc, argv, rows, check);
    if (parsed.status) return parsed.status;
    job.run.settings = std::move(parsed.settings);
    return std::nullopt;
}

}  // namespace shadowcache
