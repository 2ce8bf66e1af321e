#include <algorithm>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <string>
#include <vector>

#include "common/base/error.h"
#include "common/base/exit_status.h"
#include "common/base/report_failure.h"
#include "common/cli/command_line.h"
#include "scenes/sets.h"

namespace shadowcache::scenes {
namespace {

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

struct Arguments {
    std::size_t set = 0;
    std::string output;
    std::string camera;
    std::int64_t triangles = 1'000'000;
};

constexpr const char* kFooter =
    "Examples:\n"
    "  shadowcache-make-set courtyard -o courtyard.glb --camera courtyard.json\n"
    "  shadowcache-make-set night -o night.glb --camera night.json\n"
    "  shadowcache-make-set scatter --triangles 10000000 -o scatter.ply";

std::vector<OptionRow> optionRows(Arguments& a) {
    std::vector<std::string> names;
    std::string help;
    for (const BundledSet& set : kSets) {
        names.emplace_back(set.name);
        help += std::string(set.name) + ": " + set.what + "; ";
    }
    names.emplace_back("scatter");
    OptionRow set = option_row::word(
        "set", [&a](std::size_t i) { a.set = i; }, names, help + "scatter: rocks and grass");
    set.isPositional = true;
    OptionRow output =
        textRow("output", a.output, "the set: .glb, with materials, or .ply; scatter: .ply alone");
    output.letter = 'o';
    // What is out of range is refused by writeScatter().
    OptionRow triangles = option_row::whole(
        "triangles", [&a](std::int64_t n) { a.triangles = n; }, {},
        "triangles of the scattered set");
    triangles.standard = std::to_string(a.triangles);
    std::vector<OptionRow> rows{set.required(), output.required(),
                                textRow("camera", a.camera, "camera of 24 frames, a JSON file"),
                                triangles};
    for (OptionRow& row : rows) row.group = "Options";
    return rows;
}

/// What only glTF can hold.
bool needsGlb(const SetMesh& mesh) {
    return !mesh.lamps.empty() ||
           std::ranges::find(mesh.finishes, Finish::pane) != mesh.finishes.end();
}

void writeSet(const Arguments& a) {
    const bool glb = std::filesystem::path(a.output).extension() == ".glb";
    if (a.set == kScattered) {
        if (glb) throw Error(a.output + ": the scattered set is written as PLY only");
        writeScatter(a.output, a.triangles);
        if (!a.camera.empty()) writeCamera(a.camera, scatterWalk(a.triangles), 24, 12, 0.9);
        return;
    }
    const BundledSet& set = kSets[a.set];
    const SetMesh mesh = set.make();
    if (!glb && needsGlb(mesh))
        throw Error(a.output + ": a set with lamps or panes is written as .glb only");
    (glb ? writeGlb : writePly)(a.output, mesh);
    if (!a.camera.empty()) writeCamera(a.camera, set.walk(), 24, 12, set.fovY);
}

}  // namespace
}  // namespace shadowcache::scenes

/// Writes one of the bundled sets: shadowcache-make-set NAME -o FILE
int main(int argc, char** argv) try {
    using namespace shadowcache;
    scenes::Arguments arguments;
    const ParsedLine parsed = parseCommandLine(
        {"shadowcache-make-set",
         "Writes a bundled set (+Y up, metres) and a camera that moves through it.",
         scenes::kFooter},
        argc, argv, scenes::optionRows(arguments));
    if (parsed.status) return *parsed.status;
    scenes::writeSet(arguments);
    return kDone;
} catch (const std::exception& e) {
    return shadowcache::reportFailure("shadowcache-make-set", e);
}
