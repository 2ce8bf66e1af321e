#include "common/shot/moving_set.h"

#include <fmt/core.h>

#include <algorithm>
#include <iterator>
#include <string>
#include <vector>

#include "common/import/gltf_mesh.h"
#include "common/import/load_mesh.h"
#include "common/import/local_space.h"
#include "common/import/mesh_options.h"
#include "common/mesh/traceable.h"

namespace shadowcache {

namespace {

/// Makes anything invisible.
const Affine kPoint{{Vec3d(0.0), Vec3d(0.0), Vec3d(0.0)}, Vec3d(0.0)};

/// Makes instances of all that a file has in its world directly.
void makeMovable(RawMesh& raw) {
    if (raw.parts.empty()) raw.parts.push_back({raw.faceSizes.size(), -1, 0});
    int group = 1;
    for (const RawInstance& instance : raw.instances) group = std::max(group, instance.group + 1);
    bool any = false;
    for (RawPart& part : raw.parts) {
        if (part.group != 0) continue;
        part.group = group;
        any = true;
    }
    if (any) raw.instances.push_back({group, {}});
    raw.firstLocalVertex = 0;
    bringNearOrigin(raw);
}

/// What makes places of a file's meshes places of the meshes as they are kept.
std::vector<Affine> toGroups(const RawMesh& raw) {
    std::vector<Affine> all;
    for (const RawInstance& instance : raw.instances) all.push_back(instance.toGroup);
    return all;
}

}  // namespace

MovingSet::MovingSet(std::span<const GltfShot> shots, std::span<const DynamicObject> objects,
                     const MeshOptions& options, const Vec3d& origin)
    : objects_(objects), options_(options) {
    options_.origin = origin;
    for (const GltfShot& shot : shots) addNodes(shot, shot.movingNodes(), nullptr);
    for (const DynamicObject& object : objects) {
        if (!object.shot) {
            addFile(object);
            continue;
        }
        const GltfNodes& all = object.shot->nodes();
        std::vector<int> nodes = all.meshNodes(false);
        const std::vector<int> moving = all.meshNodes(true);
        nodes.insert(nodes.end(), moving.begin(), moving.end());
        addNodes(*object.shot, nodes, &object);
    }
}

void MovingSet::addNodes(const GltfShot& shot, const std::vector<int>& nodes,
                         const DynamicObject* object) {
    for (const bool deforms : {false, true}) {
        Source source;
        for (const int node : nodes)
            if (shot.nodes().deforms(node) == deforms) source.nodes.push_back(node);
        if (source.nodes.empty()) continue;
        source.path = shot.document().path;
        source.shot = &shot;
        source.object = object;
        source.deforms = deforms;
        GltfPose pose = shot.pose(source.nodes, 0);
        RawMesh raw = gltfMesh(shot.document(), pose, true);
        source.toGroup = toGroups(raw);
        source.mesh = assembleMesh(source.path, std::move(raw), options_);
        source.placements = std::move(pose.placements);
        sources_.push_back(std::move(source));
    }
}

void MovingSet::addFile(const DynamicObject& object) {
    RawMesh raw = readMeshFile(object.file.mesh, options_.references);
    makeMovable(raw);
    Source source;
    source.path = object.file.mesh;
    source.object = &object;
    source.mesh = assembleMesh(source.path, std::move(raw), options_);
    for (const MeshInstance& instance : source.mesh.instances) {
        Affine atRest = instance.toWorld;
        atRest.position += *options_.origin;
        source.atRest.push_back(atRest);
    }
    sources_.push_back(std::move(source));
}

std::size_t MovingSet::triangles() const {
    std::size_t sum = 0;
    for (const Source& source : sources_) sum += source.mesh.report.placed;
    return sum;
}

std::vector<std::string> MovingSet::lampNames() const {
    std::vector<std::string> names;
    for (const Source& source : sources_)
        std::ranges::move(shadowcache::lampNames(source.mesh), std::back_inserter(names));
    return names;
}

void MovingSet::requireFrame(int frame) const {
    for (const DynamicObject& object : objects_) object.trackAt(frame);
}

bool MovingSet::deform(Source& source, int frame) const {
    const GltfShot& shot = *source.shot;
    RawMesh raw =
        gltfMesh(shot.document(), shot.pose(source.nodes, frame), true, GltfPictures::leave);
    std::vector<Affine> toGroup = toGroups(raw);
    auto mesh = assembleIfAny(source.path, std::move(raw), options_);
    if (!mesh) return false;
    source.toGroup = std::move(toGroup);
    mesh->textures = std::move(source.mesh.textures);
    source.mesh = *std::move(mesh);
    return true;
}

Affine MovingSet::placeOf(const Source& source, const MeshInstance& instance, std::size_t number,
                          int frame) {
    if (!source.shot) return source.atRest[number];
    return compose(source.shot->place(source.placements[instance.source], frame),
                   source.toGroup[instance.source]);
}

void MovingSet::setGains(std::span<const LampGain> gains) {
    options_.gains.assign(gains.begin(), gains.end());
    for (Source& source : sources_) applyGains(gains, source.mesh);
}

const Scene* MovingSet::pose(int frame) {
    // The scenes refer to the meshes, which change now.
    scenes_.clear();
    for (Source& source : sources_) {
        const Affine track =
            source.object ? source.object->trackAt(frame).value_or(Affine()) : Affine();
        const bool isVisible = !source.deforms || deform(source, frame);
        for (std::size_t i = 0; i < source.mesh.instances.size(); ++i) {
            MeshInstance& instance = source.mesh.instances[i];
            instance.toWorld =
                isVisible ? compose(track, placeOf(source, instance, i, frame)) : kPoint;
            instance.toWorld.position -= source.mesh.origin;
        }
        requireTraceable(source.mesh, fmt::format("{}, frame {}", source.path.string(), frame));
        scenes_.push_back(std::make_unique<Scene>(source.mesh));
        if (scenes_.size() > 1) scenes_.back()->setMoving(scenes_[scenes_.size() - 2].get());
    }
    return scenes_.empty() ? nullptr : scenes_.back().get();
}

}  // namespace shadowcache
