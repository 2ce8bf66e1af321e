#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/import/mesh_options.h"
#include "common/shot/moving_set.h"

namespace CLI {  // NOLINT(readability-identifier-naming)
class App;
}

namespace shadowcache {

/// A set and a shot of it, as the command lines of bake, render and farm name them.
struct ShotArguments {
    std::vector<std::filesystem::path> files;
    bool zUp = false;
    double scale = 1;             ///< metres per unit of the files
    std::optional<int> setFrame;  ///< of glTF files, in whose pose all of the set stands still
    bool allowExternal = false;   ///< files of glTF and OBJ sets outside of their folders

    std::string camera;                ///< file or name; empty: none
    std::string frames;                ///< as parseFrames reads them; empty: not given
    double shutter = 0;                ///< CameraOptions::shutter
    double fps = 24;                   ///< of glTF's cameras and moving nodes
    std::string size = "960x540";      ///< of a picture
    std::vector<std::string> dynamic;  ///< as parseDynamic reads them
};

/// Defines SET, --up and --scale, and in the group `details` --set-frame and --allow-external.
void addSetOptions(CLI::App& app, ShotArguments& shot, const std::string& group,
                   const std::string& details);

/// Defines --camera, --frames, --fps, --size and --dynamic, and in the group `details` --shutter.
void addShotOptions(CLI::App& app, ShotArguments& shot, const std::string& group,
                    const std::string& details);

/// `others`, with how the files are brought into the world.
///
/// @throws Error if a number is out of range
MeshOptions meshOptionsOf(const ShotArguments& shot, const MeshOptions& others = {});

/// Width and height of a picture. @throws Error
std::array<int, 2> sizeOf(const ShotArguments& shot);

std::vector<DynamicFile> dynamicFilesOf(const ShotArguments& shot);

}  // namespace shadowcache
