#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/import/mesh_options.h"
#include "common/math/affine.h"
#include "common/shot/gltf_shot.h"

namespace shadowcache {

/// A file that is rendered and casts shadows but is no part of the set, as --dynamic names it.
struct DynamicFile {
    std::filesystem::path mesh;
    std::filesystem::path track;  ///< where it stands in each frame; empty: as the file has it
};

/// "FILE" or "FILE@TRACK.json" -> both.
DynamicFile parseDynamic(const std::string& text);

/// Reads {"frames": [{"translation": [x, y, z], "rotation": [x, y, z, w], "scale": [x, y, z]},
/// ...]}; each of the three may be left out. frames[0] is frame 1.
///
/// @throws Error naming the file, the key, the value found and the one wanted
std::vector<Affine> readTransformTrack(const std::filesystem::path& path);

/// A file of --dynamic that was opened, with its track.
class DynamicObject {
public:
    /// @param fps  of its glTF animations
    /// @throws Error as GltfShot and readTransformTrack()
    DynamicObject(DynamicFile dynamic, const MeshOptions& options, double fps);

    DynamicFile file;
    std::unique_ptr<const GltfShot> shot;  ///< of glTF files; else null

    /// What moves it from where its file has it, in the world; none: it has no track.
    ///
    /// @throws Error naming the track, if that has no such frame
    std::optional<Affine> trackAt(int frame) const;

private:
    std::vector<Affine> track_;  ///< by frame from 1; empty: none
};

/// @throws Error as DynamicObject
std::vector<DynamicObject> openDynamic(std::span<const DynamicFile> files,
                                       const MeshOptions& options, double fps);

}  // namespace shadowcache
