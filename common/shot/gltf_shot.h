#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/import/gltf_nodes.h"
#include "common/import/gltf_pose.h"
#include "common/import/mesh_options.h"
#include "common/mesh/mesh.h"
#include "common/shot/camera.h"

namespace shadowcache {

/// What a glTF file brings to a shot beside its set: cameras, and nodes over time. Frame f is at
/// f / fps seconds, as Blender exports it.
class GltfShot {
public:
    /// @throws Error as readGltfDocument
    GltfShot(const std::filesystem::path& path, const MeshOptions& options, double fps);

    /// Forgets the arrays unless meshes that change their form need them; from now on no other mesh
    /// of document() can be read.
    void dropData();

    const GltfDocument& document() const { return *document_; }
    const GltfNodes& nodes() const { return *nodes_; }

    /// Nodes of the scene with a camera.
    std::vector<int> cameraNodes() const;
    /// Nodes of the scene with a mesh that an animation moves or changes; none of a set that stands
    /// still (MeshOptions::stillAt).
    std::vector<int> movingNodes() const;
    /// The same with a lamp.
    std::vector<int> movingLampNodes() const;
    /// Of a node's camera: the node's name, or else the camera's; may be empty.
    std::string cameraName(int node) const;

    /// @throws Error if the node's scale leaves no direction of view
    Camera camera(int node, double frame) const;
    /// What of the node a picture does not show: it mirrors, or its axes are sheared; empty:
    /// nothing.
    std::string cameraNote(int node, double frame) const;
    /// A node's place in the world.
    Affine place(int node, double frame) const;
    /// A mesh's place in the world.
    Affine place(const GltfPlacement& placement, int frame) const;
    /// Nodes with meshes in a frame.
    GltfPose pose(std::span<const int> nodes, int frame) const;

    double fps() const { return fps_; }
    /// As MeshOptions::stillAt.
    std::optional<double> stillAt() const { return stillAt_; }

private:
    std::unique_ptr<GltfDocument> document_;
    std::unique_ptr<GltfNodes> nodes_;
    Affine world_;
    double fps_;
    std::optional<double> stillAt_;
};

/// The glTF files among those of a set.
std::vector<GltfShot> openShots(std::span<const std::filesystem::path> files,
                                const MeshOptions& options, double fps);

/// A camera of one of several files.
struct NamedCamera {
    const GltfShot* shot = nullptr;
    int node = -1;
};

/// The camera of a name, or else, if the name is a number, that one of all of the files' cameras,
/// from 0 on.
///
/// @throws Error naming all cameras if none, or more than one, has the name
NamedCamera findCamera(std::span<const GltfShot> shots, const std::string& name);

/// What --list prints of a file: cameras, lamps, animations, sizes.
///
/// @param firstCamera  number of its first camera among those of all files
std::string describe(const GltfShot& shot, std::size_t firstCamera = 0);
/// What it prints of a file of --dynamic: what shines in it.
std::string describeMovingLamps(const GltfShot& shot);

}  // namespace shadowcache
