#include "common/import/gltf_pose.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "common/base/error.h"
#include "common/import/gltf_budget.h"

namespace shadowcache {

namespace {

/// Numbers of a budget that a transform takes.
constexpr std::size_t kOfTransform = 4;

/// Poses nodes one after the other.
class Poser {
public:
    Poser(const GltfDocument& document, const GltfNodes& nodes, double seconds)
        : document_(document),
          nodes_(nodes),
          seconds_(seconds),
          budget_(document),
          world_(document.nodes.size()) {}

    void add(int number) {
        const GltfNode& node = document_.nodes[static_cast<std::size_t>(number)];
        if (node.skin >= 0 && !node.instancing.empty())
            fail(node, "EXT_mesh_gpu_instancing of a mesh with a skin, expected one of them");
        const std::size_t shape = shapeOf(number);
        if (node.skin >= 0) {
            pose_.placements.push_back({number, shape, {}, {}});
            return;
        }
        const Affine place = nodes_.at(number, seconds_);
        for (const Affine& copy : copiesOf(node))
            pose_.placements.push_back({number, shape, copy, compose(place, copy)});
    }

    GltfPose finish() { return std::move(pose_); }

private:
    [[noreturn]] void fail(const GltfNode& node, const std::string& cause) const {
        throwFileError(document_.path, "node " + node.name + ": " + cause);
    }

    /// Joint to world; each node's is found once, however deep the tree.
    const Affine& world(int number) {
        std::vector<int> open;
        for (int n = number; n >= 0 && !world_[static_cast<std::size_t>(n)];
             n = document_.nodes[static_cast<std::size_t>(n)].parent)
            open.push_back(n);
        for (; !open.empty(); open.pop_back()) {
            const auto n = static_cast<std::size_t>(open.back());
            const int parent = document_.nodes[n].parent;
            const Affine local = nodes_.local(open.back(), seconds_);
            world_[n] =
                parent < 0 ? local : compose(*world_[static_cast<std::size_t>(parent)], local);
        }
        return *world_[static_cast<std::size_t>(number)];
    }

    /// Nodes that show a mesh in the same form share a shape. A skin's is its own.
    std::size_t shapeOf(int number) {
        const GltfNode& node = document_.nodes[static_cast<std::size_t>(number)];
        GltfShape shape{node.mesh, nodes_.weights(number, seconds_), {}};
        while (!shape.weights.empty() && shape.weights.back() == 0) shape.weights.pop_back();
        if (node.skin >= 0) {
            shape.joints = jointsOf(node);
            pose_.shapes.push_back(std::move(shape));
            return pose_.shapes.size() - 1;
        }
        const auto [found, isNew] =
            known_.try_emplace({shape.mesh, shape.weights}, pose_.shapes.size());
        if (isNew) pose_.shapes.push_back(std::move(shape));
        return found->second;
    }

    std::vector<Affine> jointsOf(const GltfNode& node) {
        const GltfSkin& skin = document_.skins[static_cast<std::size_t>(node.skin)];
        budget_.take(kOfTransform * skin.joints.size());
        std::vector<double> bind;
        if (skin.inverseBind >= 0) {
            std::string cause;
            const GltfAccessor& accessor = document_.accessor(skin.inverseBind);
            budget_.take(accessor.count * accessor.array.components);
            bind = decode(accessor, cause);
            if (!cause.empty()) fail(node, "inverse bind matrices: " + cause);
            if (accessor.array.components != 16 || accessor.count < skin.joints.size())
                fail(node,
                     fmt::format("{} inverse bind matrices of {} numbers for a skin of {} joints, "
                                 "expected one of 16 for each",
                                 accessor.count, accessor.array.components, skin.joints.size()));
        }
        std::vector<Affine> joints;
        joints.reserve(skin.joints.size());
        for (std::size_t i = 0; i < skin.joints.size(); ++i) {
            Affine toJoint;
            if (!bind.empty()) toJoint = affineOf(&bind[16 * i]);
            joints.push_back(compose(world(skin.joints[i]), toJoint));
            if (!joints.back().isFinite())
                fail(node, fmt::format("joint {} of its skin is not finite", i));
        }
        return joints;
    }

    /// Of a matrix, column after column; the last row has nothing to say.
    static Affine affineOf(const double* m) {
        return {{Vec3d(m[0], m[1], m[2]), Vec3d(m[4], m[5], m[6]), Vec3d(m[8], m[9], m[10])},
                Vec3d(m[12], m[13], m[14])};
    }

    /// Where EXT_mesh_gpu_instancing puts copies in the node; one in its origin without.
    std::vector<Affine> copiesOf(const GltfNode& node) {
        if (node.instancing.empty()) return {Affine{}};
        const std::size_t count = document_.copiesOf(node);
        budget_.take(kOfTransform * count);
        const std::vector<double> move = attribute(node, "TRANSLATION", 3),
                                  turn = attribute(node, "ROTATION", 4),
                                  scale = attribute(node, "SCALE", 3);
        std::vector<Affine> copies;
        copies.reserve(count);
        for (std::size_t i = 0; i < count; ++i) {
            const auto vector = [&](const std::vector<double>& from, double fallback) {
                return from.empty() ? Vec3d(fallback)
                                    : Vec3d(from[3 * i], from[3 * i + 1], from[3 * i + 2]);
            };
            std::array<double, 4> rotation{0, 0, 0, 1};
            for (std::size_t k = 0; k < 4 && !turn.empty(); ++k) rotation[k] = turn[4 * i + k];
            copies.push_back(fromParts(vector(move, 0), rotation, vector(scale, 1)));
            if (!copies.back().isFinite()) fail(node, fmt::format("instance {} is not finite", i));
        }
        return copies;
    }

    std::vector<double> attribute(const GltfNode& node, const char* name,
                                  std::size_t components) const {
        const auto found = node.instancing.find(name);
        if (found == node.instancing.end()) return {};
        const GltfAccessor& accessor = document_.accessor(found->second);
        std::string cause;
        std::vector<double> values = decode(accessor, cause);
        if (!cause.empty())
            fail(node, std::string("EXT_mesh_gpu_instancing ") + name + ": " + cause);
        if (accessor.array.components != components || accessor.count != document_.copiesOf(node))
            fail(node,
                 fmt::format(
                     "EXT_mesh_gpu_instancing {}: {} elements of {} components, expected {} of {}",
                     name, accessor.count, accessor.array.components, document_.copiesOf(node),
                     components));
        return values;
    }

    const GltfDocument& document_;
    const GltfNodes& nodes_;
    double seconds_;
    GltfBudget budget_;
    std::vector<std::optional<Affine>> world_;  ///< by node
    std::map<std::pair<int, std::vector<double>>, std::size_t> known_;
    GltfPose pose_;
};

}  // namespace

GltfPose poseOf(const GltfDocument& document, const GltfNodes& nodes, std::span<const int> which,
                double seconds) {
    Poser poser(document, nodes, seconds);
    for (const int node : which) poser.add(node);
    return poser.finish();
}

}  // namespace shadowcache
