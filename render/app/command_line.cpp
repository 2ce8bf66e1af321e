#include "render/app/command_line.h"

#include <algorithm>
#include <initializer_list>
#include <string_view>
#include <vector>

#include "common/cli/command_line.h"
#include "render/library/option_table.h"

namespace shadowcache {

namespace {

/// All but --list, --serve and --mix need these.
void requireWhatRendersNeed(const RenderJob& job) {
    if (job.run.output.empty()) throw FormError("--output is required");
    if (job.camera.name.empty() && !job.camera.eye)
        throw FormError("--camera, or --eye with --look-at, is required");
}

/// Refuses all options but some beside one that renders nothing of its own.
void requireOnly(const ParsedLine& parsed, std::string_view with,
                 std::initializer_list<std::string_view> those) {
    for (const std::string& option : parsed.given)
        if (option != with && std::ranges::find(those, option) == those.end())
            throw FormError(std::string(with) + " excludes " + option);
}

/// Whether an option is on a command line, as a word of its own or with its value.
bool isGiven(std::string_view option, int argc, char** argv) {
    return std::any_of(argv, argv + argc, [option](std::string_view word) {
        return word == option ||
               (word.starts_with(option) && word.substr(option.size()).starts_with('='));
    });
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
    "  shadowcache-render room.glb --cache room.vdb --camera still --light-groups '*' -o a.exr\n"
    "  shadowcache-render --mix a.exr --gain 'desk*=0.3' --gain sky=0 -o b.exr\n"
    "  shadowcache-render --config shot.toml --explain";

}  // namespace

std::optional<int> parseArguments(int argc, char** argv, RenderJob& job) {
    std::vector<std::string> groups{"Options", "Settings file"};
    groups.insert(groups.end(), std::begin(kShortHelp), std::end(kShortHelp));
    std::vector<OptionRow> rows = optionRows(job);
    // Requests name the set, and pictures need none.
    if (isGiven("--serve", argc, argv) || isGiven("--mix", argc, argv))
        rows.front().isRequired = false;
    const auto check = [&](const ParsedLine& parsed) {
        // Requests say all that a run takes.
        if (job.run.serve) return requireOnly(parsed, "--serve", {"--threads"});
        if (!job.run.mix.empty()) {
            if (job.run.output.empty()) throw FormError("--output is required");
            return requireOnly(parsed, "--mix",
                               {"--gain", "--output", "--half", "--png", "--exposure"});
        }
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
    // Pictures are those of the cache, whoever bakes it.
    for (auto& [name, value] : job.run.settings)
        if (name == "bake") name = "cache";
    return std::nullopt;
}

}  // namespace shadowcache
