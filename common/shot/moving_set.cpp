#include "common/shot/moving_set.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/base/error.h"
#include "common/base/file_bytes.h"
#include "common/base/json_depth.h"
#include "common/base/json_keys.h"
#include "common/import/gltf_mesh.h"
#include "common/import/load_mesh.h"
#include "common/import/local_space.h"
#include "common/import/mesh_options.h"
#include "common/mesh/traceable.h"

namespace shadowcache {

namespace {

using Json = nlohmann::json;

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

/// Lamps of what moves would be missing.
void refuseLamps(const GltfDocument& document) {
    if (std::ranges::any_of(document.nodes,
                            [](const GltfNode& node) { return node.inScene && node.light >= 0; }))
        throwFileError(
            document.path,
            "has lamps, expected none in a file of --dynamic; --lamps off leaves them out");
}

std::vector<double> numbers(const std::filesystem::path& path, const Json& frame, const char* name,
                            std::vector<double> fallback) {
    const auto found = frame.find(name);
    if (found == frame.end()) return fallback;
    std::vector<double> values;
    if (found->is_array())
        for (const Json& value : *found)
            if (value.is_number()) values.push_back(value.get<double>());
    const bool finite =
        std::all_of(values.begin(), values.end(), [](double x) { return std::isfinite(x); });
    if (values.size() != fallback.size() || !found->is_array() ||
        found->size() != fallback.size() || !finite)
        throwFileError(path,
                       fmt::format("{} is not a list of {} finite numbers", name, fallback.size()));
    return values;
}

}  // namespace

DynamicFile parseDynamic(const std::string& text) {
    // A file may have an @ in its name; a track's name ends in .json.
    const std::size_t at = text.rfind('@');
    if (at == std::string::npos || !text.ends_with(".json")) return {text, {}};
    return {text.substr(0, at), text.substr(at + 1)};
}

std::vector<Affine> readTransformTrack(const std::filesystem::path& path) {
    const std::string text = readFileBytes(path);
    if (!isShallowJson(text))
        throwFileError(path, "JSON nested deeper than 256 levels, expected fewer");
    const Json json = Json::parse(text, nullptr, false);
    if (json.is_discarded()) throwFileError(path, "is not JSON, expected a track of transforms");
    const auto frames = json.is_object() ? json.find("frames") : json.end();
    if (!json.is_object() || frames == json.end() || !frames->is_array() || frames->empty())
        throwFileError(path, "has no list of frames, expected {\"frames\": [...]}");
    std::vector<Affine> track;
    const std::vector<std::string> known{"translation", "rotation", "scale"};
    for (const Json& frame : *frames) {
        if (!frame.is_object())
            throwFileError(path, fmt::format("frame {} is not an object", track.size() + 1));
        const std::string unknown =
            unknownKey(frame, fmt::format("frames[{}]", track.size()), known);
        if (!unknown.empty()) throwFileError(path, "has the " + unknown);
        const auto t = numbers(path, frame, "translation", {0, 0, 0});
        const auto q = numbers(path, frame, "rotation", {0, 0, 0, 1});
        const auto s = numbers(path, frame, "scale", {1, 1, 1});
        track.push_back(
            fromParts({t[0], t[1], t[2]}, {q[0], q[1], q[2], q[3]}, {s[0], s[1], s[2]}));
    }
    return track;
}

MovingSet::MovingSet(std::span<const GltfShot> shots, std::span<const DynamicFile> files,
                     const MeshOptions& options, const Vec3d& origin, double fps)
    : options_(options) {
    options_.origin = origin;
    for (const GltfShot& shot : shots)
        addNodes(shot, shot.movingNodes(), {shot.document().path, {}});
    for (const DynamicFile& file : files) {
        if (!isGltf(file.mesh)) {
            addFile(file);
            continue;
        }
        ownShots_.push_back(std::make_unique<GltfShot>(file.mesh, options, fps));
        if (options.lamps) refuseLamps(ownShots_.back()->document());
        const GltfNodes& all = ownShots_.back()->nodes();
        std::vector<int> nodes = all.meshNodes(false);
        const std::vector<int> moving = all.meshNodes(true);
        nodes.insert(nodes.end(), moving.begin(), moving.end());
        addNodes(*ownShots_.back(), nodes, file);
    }
}

MovingSet::~MovingSet() = default;

void MovingSet::addNodes(const GltfShot& shot, const std::vector<int>& nodes,
                         const DynamicFile& file) {
    for (const bool deforms : {false, true}) {
        Source source;
        for (const int node : nodes)
            if (shot.nodes().deforms(node) == deforms) source.nodes.push_back(node);
        if (source.nodes.empty()) continue;
        source.path = file.mesh;
        source.shot = &shot;
        source.deforms = deforms;
        GltfPose pose = shot.pose(source.nodes, 0);
        RawMesh raw = gltfMesh(shot.document(), pose, true);
        source.toGroup = toGroups(raw);
        source.mesh = assembleMesh(file.mesh, std::move(raw), options_);
        source.placements = std::move(pose.placements);
        source.trackPath = file.track;
        if (!file.track.empty()) source.track = readTransformTrack(file.track);
        sources_.push_back(std::move(source));
    }
}

void MovingSet::addFile(const DynamicFile& file) {
    RawMesh raw = readMeshFile(file.mesh, options_.references);
    makeMovable(raw);
    Source source;
    source.path = file.mesh;
    source.mesh = assembleMesh(file.mesh, std::move(raw), options_);
    for (const MeshInstance& instance : source.mesh.instances) {
        Affine atRest = instance.toWorld;
        atRest.position += *options_.origin;
        source.atRest.push_back(atRest);
    }
    source.trackPath = file.track;
    if (!file.track.empty()) source.track = readTransformTrack(file.track);
    sources_.push_back(std::move(source));
}

std::size_t MovingSet::triangles() const {
    std::size_t sum = 0;
    for (const Source& source : sources_) sum += source.mesh.report.placed;
    return sum;
}

Affine MovingSet::trackAt(const Source& source, int frame) {
    if (source.track.empty()) return {};
    if (frame < 1 || static_cast<std::size_t>(frame) > source.track.size())
        throwFileError(source.trackPath,
                       fmt::format("frame {}, expected 1 to {}", frame, source.track.size()));
    return source.track[static_cast<std::size_t>(frame - 1)];
}

void MovingSet::requireFrame(int frame) const {
    for (const Source& source : sources_) trackAt(source, frame);
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
        const Affine track = trackAt(source, frame);
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
