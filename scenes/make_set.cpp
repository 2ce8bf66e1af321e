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

struct Arguments {
    bool scatter = false;
    std::string output;
    std::string camera;
    std::int64_t triangles = 1'000'000;
};

constexpr const char* kFooter =
    "Examples:\n"
    "  shadowcache-make-set courtyard -o courtyard.glb --camera courtyard.json\n"
    "  shadowcache-make-set scatter --triangles 10000000 -o scatter.ply";

std::vector<OptionRow> optionRows(Arguments& a) {
    OptionRow set = option_row::word(
        "set", [&a](std::size_t i) { a.scatter = i == 1; }, {"courtyard", "scatter"},
        "courtyard or scatter");
    set.isPositional = true;
    OptionRow output =
        textRow("output", a.output, "the set: .ply, or, for the courtyard, .glb, with materials");
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

void writeSet(const Arguments& a) {
    const bool glb = std::filesystem::path(a.output).extension() == ".glb";
    if (a.scatter) {
        if (glb) throw Error(a.output + ": the scattered set is written as PLY only");
        writeScatter(a.output, a.triangles);
        if (!a.camera.empty()) writeCamera(a.camera, scatterWalk(a.triangles), 24, 12, 0.9);
        return;
    }
    const SetMesh mesh = makeCourtyard();
    (glb ? writeGlb : writePly)(a.output, mesh);
    if (!a.camera.empty()) writeCamera(a.camera, courtyardWalk(), 24, 12, 0.96);
}

}  // namespace
}  // namespace shadowcache::scenes

/// Writes one of the bundled sets: shadowcache-make-set courtyard|scatter -o FILE
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
