#pragma once

#include <optional>
#include <vector>

#include "common/import/lamp_gain.h"
#include "common/import/references.h"
#include "common/math/affine.h"

namespace shadowcache {

/// How a set's files are brought into the world.
struct MeshOptions {
    bool zUp = false;               ///< the files' up axis is +Z: rotated so that +Y is up
    double scale = 1.0;             ///< files' unit in metres, > 0
    std::optional<Vec3d> origin{};  ///< of the mesh; else its middle
    bool shadingNormals = false;    ///< reads the files' shading normals
    bool gloss = false;             ///< reads gloss and emission; else surfaces are Lambertian
    bool lamps = true;              ///< what shines in the files does; else nothing
    std::vector<LampGain> gains{};  ///< of what shines
    /// Crease angle in degrees, 0 to 180: triangles without shading normals get some, averaged over
    /// neighbours whose normals differ by at most this. 0: none.
    double smoothDegrees = 0;
    References references = References::inside;  ///< of glTF and OBJ files
    /// Time of glTF files [s] in whose pose everything stands still; else what moves is left to
    /// MovingSet.
    std::optional<double> stillAt{};
};

/// Time of a frame [s], if there is one.
///
/// @throws Error if the frames a second are out of range
std::optional<double> timeOf(std::optional<int> frame, double fps);

/// @throws Error if a --scale is not a finite number above 0
void requireScale(double scale);

/// From the files' axes and unit to the world's.
Affine worldOf(const MeshOptions& options);

}  // namespace shadowcache
