#include <CLI/CLI.hpp>
#include <exception>

#include "common/base/error.h"
#include "common/base/exit_status.h"
#include "common/base/report_failure.h"
#include "common/cli/command_line.h"
#include "scenes/sets.h"

/// Writes one of the bundled sets: shadowcache-make-set courtyard|scatter -o FILE
int main(int argc, char** argv) try {
    namespace scenes = shadowcache::scenes;
    CLI::App app("Writes a bundled set (+Y up, metres) and a camera that moves through it.",
                 "shadowcache-make-set");
    shadowcache::beginCommandLine(app);
    bool scatter = false;
    std::string output;
    std::string camera;
    std::int64_t triangles = 1'000'000;
    shadowcache::OptionRow set = shadowcache::option_row::word(
        "set", [&](std::size_t i) { scatter = i == 1; }, {"courtyard", "scatter"},
        "courtyard or scatter");
    set.isPositional = true;
    set.group = "Options";
    app.add_option("-o,--output", output,
                   "the set: .ply, or, for the courtyard, .glb, with materials")
        ->required();
    app.add_option("--camera", camera, "camera of 24 frames, a JSON file");
    app.add_option("--triangles", triangles, "triangles of the scattered set")
        ->capture_default_str();
    app.footer(
        "Examples:\n"
        "  shadowcache-make-set courtyard -o courtyard.glb --camera courtyard.json\n"
        "  shadowcache-make-set scatter --triangles 10000000 -o scatter.ply");
    if (const auto status =
            shadowcache::parseCommandLine(app, argc, argv, std::vector{set.required()}))
        return *status;

    const bool glb = std::filesystem::path(output).extension() == ".glb";
    if (scatter) {
        if (glb) throw shadowcache::Error(output + ": the scattered set is written as PLY only");
        scenes::writeScatter(output, triangles);
        if (!camera.empty())
            scenes::writeCamera(camera, scenes::scatterWalk(triangles), 24, 12, 0.9);
    } else {
        const scenes::SetMesh mesh = scenes::makeCourtyard();
        (glb ? scenes::writeGlb : scenes::writePly)(output, mesh);
        if (!camera.empty()) scenes::writeCamera(camera, scenes::courtyardWalk(), 24, 12, 0.96);
    }
    return 0;
} catch (const std::exception& e) {
    return shadowcache::reportFailure("shadowcache-make-set", e);
}
