#include "common/command/shot_arguments.h"

#include <CLI/CLI.hpp>

#include "common/cli/command_line.h"
#include "common/cli/options.h"

namespace shadowcache {

namespace {

constexpr Named<bool> kUpAxes[] = {{"y", false}, {"z", true}};

}  // namespace

void addSetOptions(CLI::App& app, ShotArguments& shot, const std::string& group,
                   const std::string& details) {
    app.add_option("SET", shot.files,
                   "Geometry files (glTF, OBJ, PLY, STL, OFF, OM); several files form one set")
        ->required()
        ->take_all();
    addChoice(app, "--up", shot.zUp, kUpAxes, "Up axis of the files: y or z")->group(group);
    app.add_option("--scale", shot.scale, "Metres per unit of the files, above 0")
        ->capture_default_str()
        ->group(group);
    app.add_option(
           "--set-frame", shot.setFrame,
           "Frame of glTF files in whose pose all of the set stands still [none: what moves "
           "is rendered in each frame and not baked]")
        ->group(details);
    app.add_flag("--allow-external", shot.allowExternal,
                 "Let glTF and OBJ files name files outside of their folders")
        ->group(details);
}

void addShotOptions(CLI::App& app, ShotArguments& shot, const std::string& group,
                    const std::string& details) {
    app.add_option("--camera", shot.camera,
                   "Camera file (JSON), or the name or number of a camera in a glTF set")
        ->group(group);
    app.add_option("--shutter", shot.shutter,
                   "Share of a frame's time that the camera moves in while it is exposed, half "
                   "before and half after the frame, 0 to 1; objects stand still")
        ->capture_default_str()
        ->group(details);
    app.add_option("--frames", shot.frames,
                   "Frames of the shot: A, A-B or A-BxSTEP, joined by commas [1]")
        ->group(group);
    app.add_option("--fps", shot.fps, "Frames per second of a glTF set's animations")
        ->capture_default_str()
        ->group(group);
    app.add_option("--size", shot.size, "Size of the pictures in pixels: WxH")
        ->capture_default_str()
        ->group(group);
    app.add_option("--dynamic", shot.dynamic,
                   "FILE or FILE@TRACK.json: a moving object, rendered but not part of the cache")
        ->take_all()
        ->allow_extra_args(false)
        ->group(group);
}

MeshOptions meshOptionsOf(const ShotArguments& shot, const MeshOptions& others) {
    requireScale(shot.scale);
    MeshOptions mesh = others;
    mesh.zUp = shot.zUp;
    mesh.scale = shot.scale;
    mesh.stillAt = timeOf(shot.setFrame, shot.fps);
    if (shot.allowExternal) mesh.references = References::anywhere;
    return mesh;
}

std::array<int, 2> sizeOf(const ShotArguments& shot) {
    return parsePair("--size", shot.size, "WxH, as in 960x540");
}

std::vector<DynamicFile> dynamicFilesOf(const ShotArguments& shot) {
    std::vector<DynamicFile> files;
    for (const std::string& text : shot.dynamic) files.push_back(parseDynamic(text));
    return files;
}

}  // namespace shadowcache
