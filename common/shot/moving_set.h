#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/import/mesh_options.h"
#include "common/shot/dynamic_file.h"
#include "common/shot/gltf_shot.h"
#include "common/trace/scene.h"

namespace shadowcache {

/// What moves in a shot: animated nodes of the set's files, with the skins and morph targets that
/// change their meshes, and files of their own.
class MovingSet {
public:
    /// Keeps references to `shots` and `objects`. `origin` is the static set's.
    MovingSet(std::span<const GltfShot> shots, std::span<const DynamicObject> objects,
              const MeshOptions& options, const Vec3d& origin);

    /// @throws Error if a track has no such frame
    void requireFrame(int frame) const;

    bool empty() const { return sources_.empty(); }
    std::size_t triangles() const;
    /// Names that gains may have: of materials that emit.
    std::vector<std::string> lampNames() const;

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
        const DynamicObject* object = nullptr;  ///< whose track is on top; null: it has none
        std::vector<Affine> atRest;             ///< by instance, in the file's world
        std::vector<Affine> toGroup;            ///< RawInstance::toGroup, by MeshInstance::source
    };

    void addNodes(const GltfShot& shot, const std::vector<int>& nodes, const DynamicObject* object);
    void addFile(const DynamicObject& object);
    /// @return false where nothing of it has area in that frame: the mesh is then an earlier one's
    bool deform(Source& source, int frame) const;
    static Affine placeOf(const Source& source, const MeshInstance& instance, std::size_t number,
                          int frame);

    std::span<const DynamicObject> objects_;
    MeshOptions options_;
    std::vector<Source> sources_;
    std::vector<std::unique_ptr<Scene>> scenes_;
};

}  // namespace shadowcache
