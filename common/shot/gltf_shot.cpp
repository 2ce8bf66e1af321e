#include "common/shot/gltf_shot.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>

#include "common/base/error.h"
#include "common/import/gltf_placed_lamps.h"
#include "common/import/mesh_options.h"
#include "common/import/mesh_reader.h"
#include "common/math/limits.h"

namespace shadowcache {

namespace {

/// Cosine between a camera's axes above which they are sheared, and not by rounding.
constexpr double kLeastShear = 1e-3;

/// Triangles of a mesh as its accessors announce them.
std::size_t announcedTriangles(const GltfDocument& document, int mesh) {
    std::size_t sum = 0;
    for (const GltfPrimitive& p : document.meshes[static_cast<std::size_t>(mesh)].primitives) {
        const auto positions = p.attributes.find("POSITION");
        if (p.mode < 4 || positions == p.attributes.end()) continue;
        const std::size_t corners =
            document.accessor(p.indices >= 0 ? p.indices : positions->second).count;
        sum += p.mode == 4 ? corners / 3 : corners - std::min<std::size_t>(2, corners);
    }
    return sum;
}

/// By what a camera can be chosen: its name, or its number if it has none.
std::string cameraLabel(const GltfShot& shot, int node, std::size_t number) {
    const std::string name = shot.cameraName(node);
    return name.empty() ? std::to_string(number) : name;
}

/// "from 0.1 to 100 m away".
std::string reachText(const Camera& camera) {
    return std::isfinite(camera.far)
               ? fmt::format("from {:g} to {:g} m away", camera.near, camera.far)
               : fmt::format("from {:g} m away on", camera.near);
}

/// What is seen through a camera, or why nothing is.
std::string describeCamera(const GltfShot& shot, int node) try {
    const Camera camera = shot.camera(node, 1);
    const Vec3d& at = camera.origin;
    const std::string kind =
        camera.height > 0
            ? fmt::format("orthographic, {:g} high", camera.height)
            : fmt::format("perspective, {:.4g} degrees high", camera.fovY * 180 / kPi);
    return fmt::format("{}, sees {}, at {:.4g}, {:.4g}, {:.4g} in frame 1{}\n", kind,
                       reachText(camera), at.x, at.y, at.z,
                       shot.nodes().moves(node) ? ", moves" : "");
} catch (const Error& e) {
    return fmt::format("cannot be used: {}\n", e.what());
}

std::string colorText(const Rgb& c) {
    return fmt::format("{:.4g},{:.4g},{:.4g}", c.x, c.y, c.z);
}

std::string describeLamp(const Lamp& lamp) {
    const char* kind = lamp.form == Lamp::Form::sun         ? "sun, irradiance"
                       : lamp.form == Lamp::Form::rectangle ? "rectangle, intensity"
                       : lamp.form == Lamp::Form::ellipse   ? "ellipse, intensity"
                       : lamp.cone                          ? "spot, intensity"
                                                            : "point, intensity";
    return fmt::format("  lamp {}: {} {}", lamp.name, kind, colorText(lamp.strength));
}

std::string describeMoving(const GltfShot& shot, std::span<const int> nodes) {
    std::string text;
    for (const int node : nodes)
        text += describeLamp(gltfLampAt(shot.document(), shot.nodes(), node, 0).lamp) + ", moves\n";
    return text;
}

std::string describeEmission(const GltfDocument& document) {
    std::string text;
    for (const GltfMaterial& from : document.materials) {
        const Finish& finish = from.material.finish;
        if (finish.emission == Rgb(0, 0, 0)) continue;
        text += fmt::format("  emissive material {}: radiance {}{}\n", from.name,
                            colorText(finish.emission),
                            finish.emissionTexture.texture < 0 ? "" : " times a texture");
    }
    return text;
}

/// What --lamp names.
std::string describeLamps(const GltfShot& shot) {
    const GltfDocument& document = shot.document();
    LeftOutOf leftOut;
    std::string text;
    for (const Lamp& lamp : gltfLamps(document, shot.nodes(), shot.stillAt(), leftOut))
        text += describeLamp(lamp) + "\n";
    return text + describeMoving(shot, shot.movingLampNodes()) + describeEmission(document);
}

}  // namespace

GltfShot::GltfShot(const std::filesystem::path& path, const MeshOptions& options, double fps)
    : document_(std::make_unique<GltfDocument>(readGltfDocument(path, options.references))),
      nodes_(std::make_unique<GltfNodes>(*document_)),
      world_(worldOf(options)),
      fps_(fps),
      stillAt_(options.stillAt) {}

void GltfShot::dropData() {
    const std::vector<int> moving = movingNodes();
    if (std::ranges::none_of(moving, [&](int node) { return nodes_->deforms(node); }))
        document_->storage.clear();
}

std::vector<int> GltfShot::cameraNodes() const {
    std::vector<int> found;
    for (int i = 0; i < static_cast<int>(document_->nodes.size()); ++i) {
        const GltfNode& node = document_->nodes[static_cast<std::size_t>(i)];
        if (node.inScene && node.camera >= 0) found.push_back(i);
    }
    return found;
}

std::vector<int> GltfShot::movingNodes() const {
    return stillAt_ ? std::vector<int>() : nodes_->meshNodes(true);
}

std::vector<int> GltfShot::movingLampNodes() const {
    return stillAt_ ? std::vector<int>() : shadowcache::movingLampNodes(*document_, *nodes_);
}

std::string GltfShot::cameraName(int node) const {
    const GltfNode& n = document_->nodes[static_cast<std::size_t>(node)];
    return n.name.empty() ? document_->cameras[static_cast<std::size_t>(n.camera)].name : n.name;
}

Affine GltfShot::place(int node, double frame) const {
    return compose(world_, nodes_->at(node, frame / fps_));
}

Affine GltfShot::place(const GltfPlacement& placement, int frame) const {
    // A skin's joints lead to the world.
    if (document_->nodes[static_cast<std::size_t>(placement.node)].skin >= 0) return world_;
    return compose(place(placement.node, frame), placement.inNode);
}

GltfPose GltfShot::pose(std::span<const int> nodes, int frame) const {
    return poseOf(*document_, *nodes_, nodes, frame / fps_);
}

Camera GltfShot::camera(int node, double frame) const {
    const GltfCamera& from = document_->cameras[static_cast<std::size_t>(
        document_->nodes[static_cast<std::size_t>(node)].camera)];
    if (!from.fault.empty()) throw Error(from.fault);
    const Affine at = place(node, frame);
    Camera camera;
    camera.origin = at.position;
    const auto fail = [&](const std::string& cause) {
        throwFileError(document_->path,
                       fmt::format("camera {}, frame {}: {}", cameraName(node), frame, cause));
    };
    if (!isInReach(camera.origin))
        fail(fmt::format("at {:g}, {:g}, {:g}, expected coordinates up to {:g}", camera.origin.x,
                         camera.origin.y, camera.origin.z, kMostCoordinate));
    // A camera looks along its -z; a scale has no say in that, and a shear of parents is undone.
    camera.forward = unitOf(-at.axis[2]);
    const Vec3d right = camera.forward.cross(unitOf(at.axis[1]));
    if (camera.forward == Vec3d(0.0) || !(right.length() > 1e-6))
        fail("the node's scale leaves no viewing direction");
    camera.up = right.normalized().cross(camera.forward).normalized();
    camera.fovY = from.fovY;
    camera.aspect = from.aspect;
    const double unit = world_.axis[0].length();
    if (from.orthographic) camera.height = from.height * unit;
    camera.near = from.near * unit;
    camera.far = from.far * unit;
    if (!(camera.near < kMostCoordinate))
        fail(fmt::format("znear {:g} m away, expected less than {:g}", camera.near,
                         kMostCoordinate));
    if (!(camera.height <= kMostViewHeight))
        fail(
            fmt::format("a view {:g} high, expected at most {:g}", camera.height, kMostViewHeight));
    return camera;
}

std::string GltfShot::cameraNote(int node, double frame) const {
    const Affine at = place(node, frame);
    const Vec3d x = unitOf(at.axis[0]), y = unitOf(at.axis[1]), z = unitOf(at.axis[2]);
    if (x.cross(y).dot(z) < 0)
        return "a scale below 0, its own or a parent's, mirrors it: the picture is not mirrored";
    if (std::max({std::abs(x.dot(y)), std::abs(y.dot(z)), std::abs(z.dot(x))}) > kLeastShear)
        return "a parent's scale shears it: the picture is not sheared";
    return "";
}

std::vector<GltfShot> openShots(std::span<const std::filesystem::path> files,
                                const MeshOptions& options, double fps) {
    std::vector<GltfShot> shots;
    for (const auto& file : files)
        if (isGltf(file)) shots.emplace_back(file, options, fps);
    return shots;
}

NamedCamera findCamera(std::span<const GltfShot> shots, const std::string& name) {
    std::string known;
    std::vector<NamedCamera> all, found;
    for (const GltfShot& shot : shots)
        for (const int node : shot.cameraNodes()) {
            known += (known.empty() ? "" : ", ") + cameraLabel(shot, node, all.size());
            all.push_back({&shot, node});
            const GltfNode& n = shot.document().nodes[static_cast<std::size_t>(node)];
            const GltfCamera& camera = shot.document().cameras[static_cast<std::size_t>(n.camera)];
            if (n.name == name || camera.name == name) found.push_back(all.back());
        }
    std::size_t number = 0;
    const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
    if (found.size() != 1 && error == std::errc() && end == name.data() + name.size() &&
        number < all.size())
        return all[number];
    if (found.empty())
        throw Error("--camera " + name + ": expected one of the set's cameras: " +
                    (known.empty() ? "it has none" : known));
    if (found.size() > 1)
        throw Error(fmt::format(
            "--camera {}: {} cameras of the set have this name, expected one, or its number; "
            "cameras: {}",
            name, found.size(), known));
    return found[0];
}

std::string describe(const GltfShot& shot, std::size_t firstCamera) {
    const GltfDocument& document = shot.document();
    std::set<int> meshes;
    std::size_t nodes = 0, unique = 0, placed = 0;
    for (const GltfNode& node : document.nodes) {
        if (!node.inScene || node.mesh < 0) continue;
        const std::size_t triangles = announcedTriangles(document, node.mesh);
        if (meshes.insert(node.mesh).second) unique += triangles;
        placed += triangles * document.copiesOf(node);
        ++nodes;
    }
    std::string text = document.path.string() + ":\n";
    text += fmt::format("  {} meshes with {} triangles; {} nodes place {} triangles\n",
                        meshes.size(), unique, nodes, placed);
    for (const int node : shot.cameraNodes()) {
        text += "  camera " + cameraLabel(shot, node, firstCamera++) + ": ";
        text += describeCamera(shot, node);
    }
    text += describeLamps(shot);
    for (const GltfAnimation& animation : document.animations)
        text +=
            fmt::format("  animation {}: {} channels\n", animation.name, animation.channels.size());
    for (const int node : shot.movingNodes())
        text += "  moves: " + document.nodes[static_cast<std::size_t>(node)].name +
                " (not baked, rendered in every frame)\n";
    if (!document.animations.empty())
        text +=
            fmt::format("  the last key is at {:.4g} s: frame {:.0f} at {:g} frames a second\n",
                        shot.nodes().duration(), shot.nodes().duration() * shot.fps(), shot.fps());
    return text;
}

std::string describeMovingLamps(const GltfShot& shot) {
    const GltfDocument& document = shot.document();
    return document.path.string() + ":\n" + describeMoving(shot, lampNodes(document)) +
           describeEmission(document);
}

}  // namespace shadowcache
