#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "bake/core/voxel_selection.h"
#include "common/shot/camera_source.h"
#include "common/shot/moving_set.h"

namespace shadowcache {

/// A shot that a bake is made for.
struct ShotOptions {
    CameraOptions camera;
    std::string frames = "1";           ///< as parseFrames reads them
    std::array<int, 2> size{960, 540};  ///< of its pictures [pixels]
    int margin = 0;                     ///< voxels to bake around those that are looked up, 0 .. 64
    double fps = 24;                    ///< of glTF's cameras and moving nodes
    std::vector<DynamicFile> dynamic;
};

/// @throws Error naming the option, the value and the range allowed
void validate(const ShotOptions& options);

/// Files that hold a shot, beside those of the set: its camera's and its moving objects', as far as
/// they are files.
std::vector<std::filesystem::path> filesOf(const ShotOptions& options);

/// Cameras and moving objects of a shot.
class ShotSource {
public:
    /// Keeps references to `options` and `mesh`, which are those of the set.
    ///
    /// @throws Error if a file cannot be read or a frame has no camera
    ShotSource(const ShotOptions& options, std::span<const std::filesystem::path> files,
               const MeshOptions& mesh);

    /// Places at which its pictures look a cache up.
    ///
    /// @throws Error if a frame is missing in a moving object's track
    LookupPlaces lookups(Scene& scene, const VoxelFrame& frame) const;

    /// Pixels of all its pictures.
    std::uint64_t pixels() const;

    /// In one line: "camera.json, frames 1-24, 960x540, #5d0c43f1". The digits are of what the
    /// files hold and of the frame rate: two shots of one name differ in them.
    std::string text() const;

private:
    const ShotOptions& options_;
    const MeshOptions& mesh_;
    std::string contents_;  ///< hash of the files'
    std::vector<int> frames_;
    std::vector<GltfShot> shots_;
    CameraSource camera_;
};

}  // namespace shadowcache
