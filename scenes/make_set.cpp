#include <CLI/CLI.hpp>
#include <algorithm>
#include <exception>

#include "common/base/error.h"
#include "common/base/exit_status.h"
#include "common/base/report_failure.h"
#include "common/cli/command_line.h"
#include "scenes/sets.h"

namespace {

using namespace shadowcache::scenes;

/// A set that is a mesh, and a move of its camera.
struct BundledSet {
    const char* name;
    const char* what;
    SetMesh (*make)();
    std::vector<CameraKey> (*walk)();
    double fovY;  ///< radians
};

constexpr BundledSet kSets[] = {
    {"courtyard", "an arcaded court", makeCourtyard, courtyardWalk, 0.96},
    {"night", "the same with lanterns, and a room with a lamp and a pane", makeNight, nightWalk,
     1.05},
    {"blinds", "a room behind slats", makeBlinds, blindsWalk, 1.05},
    {"greenhouse", "a house of panes", makeGreenhouse, greenhouseWalk, 1.05},
    {"hedges", "a path between leaves", makeHedges, hedgesWalk, 0.96},
};
constexpr std::size_t kScattered = std::size(kSets);  ///< the number of the scattered set

/// What only glTF can hold.
bool needsGlb(const SetMesh& mesh) {
    return !mesh.lamps.empty() || std::ranges::find(mesh.finishes, Finish::pane) != mesh.finishes.end();
}

}  // namespace

/// Writes one of the bundled sets: shadowcache-make-set NAME -o FILE
int main(int argc, char** argv) try {
    CLI::App app("Writes a bundled set (+Y up, metres) and a camera that moves through it.",
                 "shadowcache-make-set");
    shadowcache::beginCommandLine(app);
    std::size_t chosen = 0;
    std::string output;
    std::string camera;
    std::int64_t triangles = 1'000'000;
    std::vector<std::string> names;
    std::string help;
    for (const BundledSet& set : kSets) {
        names.emplace_back(set.name);
        help += std::string(set.name) + ": " + set.what + "; ";
    }
    names.emplace_back("scatter");
    help += "scatter: rocks and grass";
    shadowcache::OptionRow row = shadowcache::option_row::word(
        "set", [&](std::size_t i) { chosen = i; }, names, help);
    row.isPositional = true;
    row.group = "Options";
    app.add_option("-o,--output", output,
                   "the set: .glb, with materials, or .ply; scatter: .ply alone")
        ->required();
    app.add_option("--camera", camera, "camera of 24 frames, a JSON file");
    app.add_option("--triangles", triangles, "triangles of the scattered set")
        ->capture_default_str();
    app.footer(
        "Examples:\n"
        "  shadowcache-make-set courtyard -o courtyard.glb --camera courtyard.json\n"
        "  shadowcache-make-set night -o night.glb --camera night.json\n"
        "  shadowcache-make-set scatter --triangles 10000000 -o scatter.ply");
    if (const auto status =
            shadowcache::parseCommandLine(app, argc, argv, std::vector{row.required()}))
        return *status;

    const bool glb = std::filesystem::path(output).extension() == ".glb";
    if (chosen == kScattered) {
        if (glb) throw shadowcache::Error(output + ": the scattered set is written as PLY only");
        writeScatter(output, triangles);
        if (!camera.empty()) writeCamera(camera, scatterWalk(triangles), 24, 12, 0.9);
        return 0;
    }
    const BundledSet& set = kSets[chosen];
    const SetMesh mesh = set.make();
    if (!glb && needsGlb(mesh))
        throw shadowcache::Error(output + ": a set with lamps or panes is written as .glb only");
    (glb ? writeGlb : writePly)(output, mesh);
    if (!camera.empty()) writeCamera(camera, set.walk(), 24, 12, set.fovY);
    return 0;
} catch (const std::exception& e) {
    return shadowcache::reportFailure("shadowcache-make-set", e);
}
