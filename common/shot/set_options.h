#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/base/option_row.h"
#include "common/import/mesh_options.h"
#include "common/shot/moving_set.h"

namespace shadowcache {

/// A set and what moves in it, as they are asked for.
struct SetOptions {
    std::vector<std::filesystem::path> files{};
    MeshOptions mesh{};  ///< but for stillAt
    /// Of glTF files, in whose pose all of the set stands still; none: what moves is left to
    /// MovingSet.
    std::optional<int> frame{};
    double fps = 24;  ///< of glTF's cameras and moving nodes
    std::vector<DynamicFile> dynamic{};
};

/// The files' mesh, with the time of the frame. @throws Error if options exclude each other
MeshOptions meshOptionsOf(const SetOptions& set);

/// SET, --up, --scale, --set-frame and --allow-external.
std::vector<OptionRow> setRows(SetOptions& set);

// What programs ask of a shot of it.
OptionRow cameraRow(std::string& name);
OptionRow shutterRow(double& shutter);
OptionRow framesRow(std::string& frames);
OptionRow fpsRow(double& fps);
OptionRow sizeRow(int& width, int& height);
OptionRow dynamicRow(std::vector<DynamicFile>& files);

}  // namespace shadowcache
