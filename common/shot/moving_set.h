#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/import/mesh_options.h"
#include "common/shot/gltf_shot.h"
#include "common/trace/scene.h"

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

/// What moves in a shot: animated nodes of the set's files, with the skins and morph targets that
/// change their meshes, and files of their own.
class MovingSet {
public:
    /// Keeps references to `shots`. `origin` is the static set's.
    MovingSet(std::span<const GltfShot> shots, std::span<const DynamicFile> files,
              const MeshOptions& options, const Vec3d& origin, double fps);
    ~MovingSet();

    /// @throws Error if a track has no such frame
    void requireFrame(int frame) const;

    bool empty() const { return sources_.empty(); }
    std::size_t triangles() const;

    /// Has what shines have other gains than those of its options.
    void setGains(std::span<const LampGain> gains);

    /// Puts everything where it is in a frame.
    ///
    /// @return its scene, valid until the next call; null if nothing moves
    /// @throws Error if a track has no such frame, or puts something out of reach
    const Scene* pose(int frame);

private:
    /// A mesh whose instances all move.
    struct Source {
        std::filesystem::path path;
        TriangleMesh mesh;
        const GltfShot* shot = nullptr;         ///< of glTF files
        std::vector<int> nodes;                 ///< of the shot
        std::vector<GltfPlacement> placements;  ///< of the nodes, by MeshInstance::source
        bool deforms = false;                   ///< the mesh is another one in each frame
        std::filesystem::path trackPath;
        std::vector<Affine> track;    ///< by frame from 1, on top; empty: none
        std::vector<Affine> atRest;   ///< by instance, in the file's world
        std::vector<Affine> toGroup;  ///< RawInstance::toGroup, by MeshInstance::source
    };

    void addNodes(const GltfShot& shot, const std::vector<int>& nodes, const DynamicFile& file);
    void addFile(const DynamicFile& file);
    /// @return false where nothing of it has area in that frame: the mesh is then an earlier one's
    bool deform(Source& source, int frame) const;
    static Affine placeOf(const Source& source, const MeshInstance& instance, std::size_t number,
                          int frame);
    static Affine trackAt(const Source& source, int frame);

    MeshOptions options_;
    std::vector<std::unique_ptr<GltfShot>> ownShots_;
    std::vector<Source> sources_;
    std::vector<std::unique_ptr<Scene>> scenes_;
};

}  // namespace shadowcache
