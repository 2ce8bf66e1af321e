#pragma once

#include <string>
#include <vector>

#include "common/import/gltf_document.h"

namespace shadowcache {

/// Scale first, then the rotation (quaternion x, y, z, w of any length), then the translation.
Affine fromParts(const Vec3d& translation, const std::array<double, 4>& rotation,
                 const Vec3d& scale);

/// A channel of an animation, decoded.
struct GltfTrack {
    GltfChannel channel;
    std::vector<double> times;   ///< rising [s]
    std::size_t size = 3;        ///< numbers of a value
    std::vector<double> values;  ///< a value for each time; with cubicSpline in-tangent, value,
                                 ///< out-tangent

    /// The value at a time, held before the first and after the last.
    std::vector<double> at(double time) const;
    bool varies() const;
};

/// The places of a document's nodes over time. Several animations of a file run together.
class GltfNodes {
public:
    /// Keeps a reference to `document`, which must outlive it.
    ///
    /// @throws Error if a track's keys are missing, out of order or not finite
    explicit GltfNodes(const GltfDocument& document);

    /// Node to world at a time.
    ///
    /// @throws Error if that is not finite
    Affine at(int node, double seconds) const;
    /// Node to its parent at a time.
    Affine local(int node, double seconds) const;
    /// Of the morph targets of a node's mesh at a time; those that are missing are 0.
    std::vector<double> weights(int node, double seconds) const;
    /// Whether an animation moves it, or a node above it; keys that are all alike move nothing.
    bool moves(int node) const;
    /// Whether an animation changes the form of its mesh: weights of morph targets, or joints.
    bool deforms(int node) const;
    /// Nodes of the scene with a mesh that stands still in all of the animations, or, with
    /// `moving`, one that does not.
    std::vector<int> meshNodes(bool moving) const;

    /// Time of the last key; 0 without animations.
    double duration() const;

private:
    const GltfDocument& document_;
    std::vector<std::vector<GltfTrack>> tracks_;  ///< by node
    std::vector<bool> isMoved_;                   ///< by node: by a track of its own
    std::vector<bool> skinMoves_;                 ///< by skin
};

}  // namespace shadowcache
