#pragma once

#include <deque>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/import/gltf_accessor.h"
#include "common/import/gltf_material.h"
#include "common/import/references.h"
#include "common/math/affine.h"
#include "common/mesh/lamp.h"
#include "common/mesh/material.h"
#include "common/mesh/mesh.h"

namespace shadowcache {

// What a glTF 2.0 file tells of a set, checked: every index names something, every accessor lies
// within its data, every number is finite. What no node of the scene leads to is left empty.

struct GltfPrimitive {
    int mode = 4;  ///< 0 points, 1 to 3 lines, 4 triangles, 5 strip, 6 fan
    int indices = -1;
    int material = -1;
    std::map<std::string, int> attributes;            ///< name -> accessor
    std::vector<std::map<std::string, int>> targets;  ///< morph targets: what they add
};

struct GltfMesh {
    std::string name;
    std::vector<GltfPrimitive> primitives;
    std::vector<double> weights;  ///< of its morph targets, unless a node has others

    /// Morph targets, those of the primitive that has most.
    std::size_t targetCount() const;
};

struct GltfNode {
    std::string name;
    int parent = -1;
    int mesh = -1;
    int camera = -1;
    int skin = -1;
    int light = -1;
    bool inScene = false;         ///< of the default scene
    std::vector<double> weights;  ///< of morph targets, in place of the mesh's; or empty
    /// Accessors of EXT_mesh_gpu_instancing by attribute, all of one length; or empty.
    std::map<std::string, int> instancing;
    std::optional<Affine> matrix;  ///< in place of the three below
    Vec3d translation{0, 0, 0};
    std::array<double, 4> rotation{0, 0, 0, 1};  ///< quaternion x, y, z, w
    Vec3d scale{1, 1, 1};
};

struct GltfSkin {
    std::vector<int> joints;  ///< nodes
    int inverseBind = -1;     ///< accessor of matrices from the mesh to the joints; -1: identities
};

struct GltfCamera {
    std::string name;
    bool orthographic = false;
    double fovY = 1.0;    ///< [rad], perspective
    double height = 1.0;  ///< of the view, orthographic
    double aspect = 0;    ///< width of the view over its height; 0: that of any picture
    double near = 0;      ///< distance from which on things are seen
    double far = std::numeric_limits<double>::infinity();  ///< and up to which
    std::string fault;  ///< why nothing can be seen through it; empty: something can
};

struct GltfChannel {
    enum class Path { translation, rotation, scale, weights };
    enum class Interpolation { step, linear, cubicSpline };
    int node = -1;
    Path path = Path::translation;
    Interpolation interpolation = Interpolation::linear;
    int times = -1;   ///< accessor [s]
    int values = -1;  ///< accessor
};

struct GltfAnimation {
    std::string name;
    std::vector<GltfChannel> channels;
};

/// A texture's sampler, and its encoded picture.
struct GltfTexture {
    Texture sampler;
    std::string_view encoded;
    std::string name;  ///< of the picture, for messages
    /// Makes a roughness of glossiness in the opacity: 1 - this times that.
    std::optional<float> glossiness{};
};

struct GltfDocument {
    std::filesystem::path path;
    std::deque<std::string> storage;  ///< what accessors and textures look into
    std::vector<GltfAccessor> accessors;
    std::vector<GltfMesh> meshes;
    std::vector<GltfNode> nodes;  ///< any order; parents form a tree
    std::vector<GltfSkin> skins;
    std::vector<GltfCamera> cameras;
    std::vector<Lamp> lights;  ///< of KHR_lights_punctual, each at the origin of its nodes
    std::vector<GltfAnimation> animations;
    std::vector<GltfMaterial> materials;
    std::vector<GltfTexture> textures;
    LeftOutOf leftOutOf;  ///< what is not read, as extensions

    const GltfAccessor& accessor(int index) const {
        return accessors[static_cast<std::size_t>(index)];
    }
    /// Copies of its mesh that a node places.
    std::size_t copiesOf(const GltfNode& node) const {
        return node.instancing.empty() ? 1 : accessor(node.instancing.begin()->second).count;
    }
};

/// Reads a .gltf with its buffers and pictures, or a .glb.
///
/// @throws Error naming the file and the cause: missing, truncated, foreign, an index out of range,
/// an extension that is required and unknown here
GltfDocument readGltfDocument(const std::filesystem::path& path,
                              References references = References::inside);

}  // namespace shadowcache
