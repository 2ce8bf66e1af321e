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
    std::vector<double> values;  ///< 3 or 4 for each time; with cubicSpline in-tangent, value,
                                 ///< out-tangent

    /// The value at a time, held before the first and after the last; out[3] for rotations only.
    std::array<double, 4> at(double seconds) const;
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
    /// Whether an animation moves it, or a node above it; keys that are all alike move nothing.
    bool moves(int node) const;

    /// Time of the last key; 0 without animations.
    double duration() const;

private:
    Affine local(int node, double seconds) const;

    const GltfDocument& document_;
    std::vector<std::vector<GltfTrack>> tracks_;  ///< by node
};

}  // namespace shadowcache
