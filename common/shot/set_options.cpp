#include "common/shot/set_options.h"

#include <limits>

#include "common/base/option_text.h"

namespace shadowcache {

namespace {

constexpr Named<bool> kUpAxes[] = {{"y", false}, {"z", true}};

constexpr int kLeastInt = std::numeric_limits<int>::min();
constexpr int kMostInt = std::numeric_limits<int>::max();

}  // namespace

MeshOptions meshOptionsOf(const SetOptions& set) {
    if (!set.mesh.shadingNormals && set.mesh.smoothDegrees > 0)
        throw Error(
            "--smooth makes shading normals, --normals geometric has none: expected one of them");
    MeshOptions mesh = set.mesh;
    mesh.stillAt = timeOf(set.frame, set.fps);
    return mesh;
}

std::vector<OptionRow> setRows(SetOptions& set) {
    OptionRow files = ownTextsRow(
        "SET",
        [&set](std::span<const std::string> texts) {
            set.files.assign(texts.begin(), texts.end());
        },
        "Geometry files (glTF, OBJ, PLY, STL, OFF, OM); several files form one set");
    files.isPositional = true;
    OptionRow external = ownRow(
        "allow-external", OptionForm::flag,
        [&set](const std::string& text) {
            set.mesh.references = text == "true" ? References::anywhere : References::inside;
        },
        "Let glTF and OBJ files name files outside of their folders");
    return {files.named("set").required().notCompared(),
            wordRow("up", set.mesh.zUp, kUpAxes, "Up axis of the files: y or z"),
            numberRow("scale", set.mesh.scale, {.least = 0, .isLeastOut = true},
                      "Metres per unit of the files, above 0"),
            wholeRow("set-frame", set.frame, kLeastInt, kMostInt,
                     "Frame of glTF files in whose pose all of the set stands still [none: what "
                     "moves is rendered in each frame and not baked]")
                .named("", "frame"),
            external};
}

OptionRow cameraRow(std::string& name) {
    return textRow("camera", name,
                   "Camera file (JSON), or the name or number of a camera in a glTF set")
        .named("name");
}

OptionRow shutterRow(double& shutter) {
    return numberRow("shutter", shutter, {0, 1},
                     "Share of a frame's time that the camera moves in while it is exposed, half "
                     "before and half after the frame, 0 to 1; objects stand still");
}

OptionRow framesRow(std::string& frames) {
    return textRow("frames", frames,
                   "Frames of the shot: A, A-B or A-BxSTEP, joined by commas [1]");
}

OptionRow sizeRow(int& width, int& height) {
    const auto read = [&width, &height](const std::string& text) {
        const auto [x, y] = pairOf("size", text, "WxH, as in 960x540");
        width = x;
        height = y;
    };
    OptionRow row =
        ownRow("size", OptionForm::numbers, read, "Size of the pictures in pixels: WxH");
    row.counts = {2};
    row.standard = std::to_string(width) + "x" + std::to_string(height);
    return row;
}

OptionRow fpsRow(double& fps) {
    return numberRow("fps", fps, {1e-3, 1e6}, "Frames per second of a glTF set's animations");
}

OptionRow dynamicRow(std::vector<DynamicFile>& files) {
    return ownTextsRow(
        "dynamic",
        [&files](std::span<const std::string> texts) {
            files.clear();
            for (const std::string& text : texts) files.push_back(parseDynamic(text));
        },
        "FILE or FILE@TRACK.json: a moving object, rendered but not part of the cache");
}

}  // namespace shadowcache
