#pragma once

#include <span>
#include <vector>

#include "common/import/mesh_options.h"
#include "common/mesh/lamp.h"
#include "common/shot/dynamic_file.h"
#include "common/shot/gltf_shot.h"

namespace shadowcache {

/// The lamps of a set that an animation moves, and all lamps of the files of --dynamic.
class MovingLamps {
public:
    /// @param shots    of the set; outlive it
    /// @param objects  likewise
    /// @param options  of the set: what moves is its world's
    /// @param origin   the set's, to which places are relative
    MovingLamps(std::span<const GltfShot> shots, std::span<const DynamicObject> objects,
                const MeshOptions& options, const Vec3d& origin);

    /// Has them other gains than those of the options.
    void setGains(std::span<const LampGain> gains);

    /// The lamps in a frame, always as many in the same order. One that is scaled to 0 there has a
    /// gain of 0.
    ///
    /// @throws Error naming the file: a lamp is out of reach, or a track has no such frame
    std::vector<Lamp> at(int frame) const;

    /// The same lamps before a frame is chosen: with their names, gains and strengths, all in the
    /// set's origin.
    std::vector<Lamp> unplaced() const;

private:
    Lamp lampAt(const GltfShot& shot, int node, int frame) const;

    std::span<const GltfShot> shots_;
    std::span<const DynamicObject> objects_;
    MeshOptions options_;
    Vec3d origin_;
};

}  // namespace shadowcache
