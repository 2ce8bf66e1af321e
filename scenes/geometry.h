#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <vector>

#include "common/math/vec.h"

namespace shadowcache::scenes {

/// Numbers in [0, 1) that depend on nothing but the arguments: the sets look the same everywhere.
double noise(std::int64_t a, std::int64_t b = 0, std::int64_t c = 0);

/// Smooth noise in [0, 1) over space; features are about one unit wide.
double smoothNoise(const Vec3d& p);

/// `base` made lighter or darker by up to `amount`, by the number `u` in [0, 1).
Rgb tinted(const Rgb& base, double amount, double u);

/// Right-handed orthonormal frame: where a part of the set stands and which way it faces.
struct Placement {
    Vec3d origin{0, 0, 0};
    Vec3d x{1, 0, 0};
    Vec3d y{0, 1, 0};
    Vec3d z{0, 0, 1};

    Vec3d operator()(double px, double py, double pz) const {
        return origin + x * px + y * py + z * pz;
    }
};

/// The frame moved by (x, y, z) and turned by `yaw` radians about its own y.
Placement moved(const Placement& at, double x, double y, double z, double yaw = 0);

/// How a surface shines: the materials of a set, see kMaterials in glb_writer.cpp.
enum class Finish { matte, honed, waxed, varnished, glazed, bronze, gilded, water, pane, lantern };

/// A lamp without a surface.
struct PointLamp {
    const char* name;
    Vec3d position;
    Rgb color;         ///< linear, at most 1
    double intensity;  ///< cd
    double radius;     ///< m
};

/// Triangles with a colour at every corner, in the order in which they were added.
struct SetMesh {
    std::vector<Vec3f> positions;
    std::vector<Rgb> colors;  ///< linear base colour
    std::vector<Vec3i> triangles;
    std::vector<Finish> finishes;  ///< of each triangle
    std::vector<PointLamp> lamps;

    int addVertex(const Vec3d& p, const Rgb& color);
    /// Adds the triangle unless two corners fall together (the pole of a lathe).
    void addTriangle(int a, int b, int c, Finish finish = Finish::matte);
};

/// What a surface is made of: its colour, from the place in the world, and how it shines.
struct Paint {
    std::function<Rgb(const Vec3d&)> color;
    Finish finish = Finish::matte;

    Rgb operator()(const Vec3d& place) const { return color(place); }
};

/// One colour everywhere.
Paint plain(const Rgb& color, Finish finish = Finish::matte);

/// `base` with smooth stains about `size` metres wide, lighter or darker by `amount`.
Paint weathered(const Rgb& base, double amount, double size, Finish finish = Finish::matte);

void addQuad(SetMesh& mesh, const std::array<Vec3d, 4>& corners, const Paint& paint);

/// Surface of rows x columns cells over (u, v) in [0, 1]^2; front side where d/du x d/dv points.
void addPatch(SetMesh& mesh, int rows, int columns,
              const std::function<Vec3d(double u, double v)>& point, const Paint& paint);

/// Box between two corners in the frame's coordinates.
void addBox(SetMesh& mesh, const Placement& at, const Vec3d& low, const Vec3d& high,
            const Paint& paint);

/// Box whose upper edges are cut off by `bevel`; without its underside, which lies on something.
void addSlab(SetMesh& mesh, const Placement& at, const Vec3d& low, const Vec3d& high, double bevel,
             const Paint& paint);

/// Solid of revolution about the frame's y; the profile holds (radius, height) from the bottom up.
void addLathe(SetMesh& mesh, const Placement& at, std::span<const Imath::V2d> profile, int segments,
              const Paint& paint);

/// Prism of a closed polygon in the frame's (x, y), counter-clockwise and convex, from z = 0 to
/// `depth`.
void addPrism(SetMesh& mesh, const Placement& at, std::span<const Imath::V2d> outline, double depth,
              const Paint& paint);

/// Moulding: the profile (outward, up) drawn along the path, whose points know their outward
/// direction (mitred where two of them differ).
struct PathPoint {
    Vec3d position;
    Vec3d outward;
    Vec3d up;
};
void addMoulding(SetMesh& mesh, std::span<const PathPoint> path,
                 std::span<const Imath::V2d> profile, const Paint& paint);

/// One pose of the set's camera.
struct CameraKey {
    Vec3d position;
    Vec3d target;
};

/// Camera path through the keys (Catmull-Rom), `frames` (> 1) frames, as the programs read it.
///
/// @throws Error if it cannot be written
void writeCamera(const std::filesystem::path& path, std::span<const CameraKey> keys, int frames,
                 double fps, double fovYRadians);

/// The triangles whose finish is asked for, with the vertices that they use (poles of lathes leave
/// some that none uses).
struct SetPart {
    std::vector<std::size_t> vertices;  ///< of the mesh
    std::vector<Vec3i> triangles;       ///< corners by their place in `vertices`
};
SetPart partOf(const SetMesh& mesh, const std::function<bool(Finish)>& isIn);

/// Binary PLY with vertex colours, linear albedo stored as sRGB, without the finishes.
///
/// @throws Error if it cannot be written
void writePly(const std::filesystem::path& path, const SetMesh& mesh);

/// Binary glTF: a part for each finish, with its material, vertex colours and smooth normals.
///
/// @throws Error if it cannot be written
void writeGlb(const std::filesystem::path& path, const SetMesh& mesh);

}  // namespace shadowcache::scenes
