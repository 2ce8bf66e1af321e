#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>

#include "common/mesh/lamp.h"
#include "common/mesh/mesh.h"

namespace shadowcache {

/// Of what emitters are made: a triangle that emits, of a surface or of a lamp with an area; or a
/// lamp that a place sees as a cap of directions (lit_cap.h).
struct EmitterPart {
    enum class Form {
        triangle,
        point,  ///< Lamp::Form::point
        sun     ///< Lamp::Form::sun
    };
    /// Stands for the triangle of what has no surface.
    static constexpr std::uint32_t kNoSurface = std::numeric_limits<std::uint32_t>::max();

    /// Stands for the table of what has none.
    static constexpr std::uint32_t kNoTable = std::numeric_limits<std::uint32_t>::max();

    Form form = Form::triangle;
    std::array<Vec3f, 3> corner{};  ///< of triangles, relative to the mesh's origin
    Vec3f centre{0};                ///< but of suns
    float radius = 0;               ///< of the ball around the centre that holds it
    float size = 0;                 ///< of triangles: length of the longest side
    /// Unit: of triangles by their winding in the file; of spots and suns to where they shine.
    Vec3f normal{0};
    /// By which radiance is multiplied to get Lamp::strength: of triangles their area [m^2], of
    /// points with a radius pi r^2 [m^2], of suns pi sin^2 of half their angle [sr]; of what has no
    /// extent 1.
    float area = 0;
    float sineSquared = 0;           ///< of suns: of half their angle
    std::optional<LampCone> cone{};  ///< of spots
    float slats = 0;         ///< of lamps with an area: cotangent of half of their spread; 0: none
    Rgb radiance{0, 0, 0};   ///< in the mean over it; times the area: Lamp::strength
    float weight = 0;        ///< luminance by which it is chosen: above 0 wherever it emits
    std::uint32_t mesh = 0;  ///< which of the meshes it is of
    std::uint32_t placed = kNoSurface;  ///< its number in the world (placed_mesh.h)
    std::uint32_t lamp = 0;             ///< of what is no surface: of TriangleMesh::lamps
    bool moves = false;                 ///< of lamps: Lamp::moves
    bool seenByCamera = false;          ///< of lamps: Lamp::seenByCamera, with an extent
    bool twoSided = false;              ///< emits on both sides
    bool varies = false;                ///< its radiance is not the same everywhere
    std::uint32_t table = kNoTable;     ///< of Emitters: EmissionTable

    /// Whether it is a surface, which stops rays and is seen.
    bool isSurface() const { return placed != kNoSurface; }
    /// Whether it has an extent: a ray may meet it.
    bool hasExtent() const { return form == Form::triangle || radius > 0 || sineSquared > 0; }
    /// Whether it is a lamp that a ray may meet.
    bool isLampToMeet() const { return !isSurface() && hasExtent(); }
};

/// What a place needs to be lit: relative to the mesh's origin.
struct Receiver {
    Vec3f position;
    Vec3f normal;  ///< unit; light comes from above the plane across it
};

/// Irradiance of a place by one emitter, if nothing is in the way.
struct Unoccluded {
    Rgb irradiance{0, 0, 0};
    float weight = 0;  ///< the same by EmitterPart::weight: above 0 wherever there is any
};

/// Distance in radii from which on some parts count as their centre: off by 2 per cent.
inline constexpr float kFarRadii = 8;
/// The same of a triangle that counts as the middles of its sides.
inline constexpr float kFarTriangleRadii = 5;

/// Radius that counts for a ball at the horizon: more than its own by what rounding could hide.
inline float horizonRadius(float radius) noexcept {
    return 1.001f * radius;
}

/// Whether a ball is all below a place's horizon.
///
/// @param height  of its centre above the horizon
inline bool isBelow(float height, float radius) noexcept {
    return height < -horizonRadius(radius);
}

/// What slats leave of the light that a place gets from a triangle: about, and above 0 wherever any
/// of it is. For chances.
float slatShareOf(const EmitterPart& triangle, const Vec3f& place) noexcept;

/// Whether what slats leave of the light that a place gets changes little over a ball with some of
/// an area.
///
/// @param triangle  of the area
bool hasSlightSlats(const EmitterPart& triangle, const Vec3f& place, float radius) noexcept;

/// Irradiance of a place by a part: within 2 per cent, or exact where it is near; where the edge of
/// a soft spot's cone is, and of areas with slats, about.
Unoccluded irradianceBy(const EmitterPart& part, const Receiver& at) noexcept;

/// Distance in radii from which on some parts count as their centre where only a chance is wanted.
inline constexpr float kRoughRadii = 2;

/// Mean height above a place's horizon of what a ball has there, about: above 0 unless isBelow().
inline float meanHeight(float height, float radius) noexcept {
    if (height >= radius) return height;
    const float above = height + horizonRadius(radius);
    return above > 0 ? above * above / (4 * radius) : 0.0f;
}

/// irradianceBy() by EmitterPart::weight, roughly where the part is not near: above 0 wherever
/// there is any. For chances.
float roughWeightBy(const EmitterPart& part, const Receiver& at) noexcept;

/// A point of a part that a place is lit from.
struct EmitterPoint {
    float u = 0, v = 0;     ///< of triangles: barycentric coordinates
    Vec3f position{0};      ///< relative to the mesh's origin; not of suns
    Vec3f direction{0};     ///< unit, towards it
    float density = 0;      ///< with which it is drawn [1/sr]; 0: the place does not see it
    bool isSingle = false;  ///< the only direction that there is, drawn with density 1
    /// Radiance there as a share of the part's; of a single direction times its solid angle.
    float share = 1;
};

/// Draws a point of a part: uniform in solid angle, but of triangles that are far in area. Where
/// slats hide some of a triangle, of what they leave, about.
///
/// @param u, v  in [0, 1)
EmitterPoint samplePoint(const EmitterPart& part, const Receiver& at, double u, double v) noexcept;

/// Density with which samplePoint() draws a point of a triangle [1/sr].
float densityAt(const EmitterPart& triangle, const Receiver& at, const Vec3f& position) noexcept;

/// Where a ray meets a lamp that has an extent.
struct LampHit {
    float distance = 0;  ///< along the ray; infinite of suns
    Rgb radiance{0, 0, 0};
    float density = 0;  ///< with which samplePoint() draws the direction [1/sr]
};

/// Meets a part that is no surface and no single direction. @param direction  unit
std::optional<LampHit> meetLamp(const EmitterPart& part, const Receiver& at,
                                const Vec3f& direction) noexcept;

}  // namespace shadowcache
