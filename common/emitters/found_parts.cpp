#include "common/emitters/found_parts.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "common/base/hash.h"
#include "common/emitters/emitted.h"
#include "common/mesh/placed_mesh.h"

namespace shadowcache {

namespace {

/// Points of a triangle whose mean radiance is that of the triangle, where it has no table.
constexpr int kMeanPoints = 32;

/// Cells of all tables of a set, at most: a quarter of a second, and 16 megabytes.
constexpr std::size_t kMostCellsOfSet = std::size_t{1} << 20;

/// Of a triangle that varies, weight of what its brightest point may emit: no point is missed.
constexpr float kLeastBrightness = 0.05f;

/// Sides of the polygon that stands for an ellipse, of the same area.
constexpr int kEllipseSides = 32;

/// The most that a point of a material may emit, whatever its gain.
Rgb mostEmitted(const Material& material) {
    return material.finish.unlit ? material.albedo : material.finish.emission;
}

bool isPlain(const TriangleMesh& mesh, const Material& material) {
    if (material.cutOut || material.blends) return false;
    if (material.finish.unlit) return material.texture < 0 && mesh.colors.empty();
    return material.finish.emissionTexture.texture < 0;
}

/// A triangle without what it emits; without area if it has none.
EmitterPart triangleOf(const std::array<Vec3d, 3>& corners) {
    EmitterPart t;
    for (std::size_t k = 0; k < 3; ++k) {
        t.corner[k] = Vec3f(corners[k]);
        t.size = std::max(t.size, static_cast<float>((corners[(k + 1) % 3] - corners[k]).length()));
    }
    const Vec3d across = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    t.area = static_cast<float>(0.5 * across.length());
    const Vec3d centre = (corners[0] + corners[1] + corners[2]) / 3;
    t.centre = Vec3f(centre);
    for (const Vec3d& corner : corners)
        t.radius = std::max(t.radius, static_cast<float>((corner - centre).length()));
    return t;
}

/// Sets what a triangle emits in the mean, and its weight.
void setMean(const TriangleMesh& mesh, std::uint32_t triangle, float most, EmitterPart& t) {
    for (int i = 0; i < kMeanPoints; ++i) {
        // A lattice of the unit square, folded to the triangle.
        float u = (static_cast<float>(i) + 0.5f) / kMeanPoints;
        float v = std::fmod(static_cast<float>(i) * 0.6180339887f + 0.5f, 1.0f);
        if (u + v > 1) u = 1 - u, v = 1 - v;
        t.radiance += emittedAt(mesh, triangle, u, v) * (1.0f / kMeanPoints);
    }
    t.weight = brightness(t.radiance) + kLeastBrightness * most;
}

/// The triangle as it emits; without area if it does not. Its radiance and weight are not yet those
/// of one that varies.
EmitterPart emissive(const TriangleMesh& mesh, std::uint32_t placed, const Material& material) {
    const std::array<Vec3d, 3> corners = placedCorners(mesh, placed);
    EmitterPart t = triangleOf(corners);
    if (!(t.area > 0)) return t;
    t.normal = placedNormal(mesh, placed, corners);
    t.placed = placed;
    t.twoSided = material.doubleSided;
    t.varies = !isPlain(mesh, material);
    if (t.varies) return t;
    t.radiance = emittedAt(mesh, placedTriangle(mesh, placed).triangle, 0, 0);
    t.weight = brightness(t.radiance);
    return t;
}

/// Sets what triangles emit that vary, and makes tables for those that vary much.
void setVarying(std::span<const TriangleMesh* const> meshes, FoundParts& found) {
    const auto varying = static_cast<std::size_t>(
        std::ranges::count_if(found.parts, [](const FoundPart& p) { return p.part.varies; }));
    if (varying == 0) return;
    const std::size_t cells = kMostCellsOfSet / varying;
    for (FoundPart& p : found.parts) {
        EmitterPart& t = p.part;
        if (!t.varies) continue;
        const TriangleMesh& mesh = *meshes[t.mesh];
        const std::uint32_t triangle = placedTriangle(mesh, t.placed).triangle;
        const Material& material = *materialOf(mesh, triangle);
        const float most = brightness(mostEmitted(material) * material.finish.gain);
        std::optional<EmissionTable> table = EmissionTable::of(mesh, triangle, most, cells);
        if (!table) {
            setMean(mesh, triangle, most, t);
            continue;
        }
        t.radiance = table->mean();
        t.weight = brightness(t.radiance) + table->floor();
        if (!table->pays()) continue;
        t.table = static_cast<std::uint32_t>(found.tables.size());
        found.tables.push_back(std::move(*table));
    }
}

void addSurfaces(const TriangleMesh& mesh, std::uint32_t number, EmitterWeight weight,
                 std::vector<FoundPart>& found) {
    if (std::ranges::none_of(mesh.materials, [](const Material& material) {
            return brightness(mostEmitted(material)) > 0;
        }))
        return;
    const auto count = static_cast<std::uint32_t>(placedCount(mesh));
    for (std::uint32_t i = 0; i < count; ++i) {
        const Material* material = materialOf(mesh, placedTriangle(mesh, i).triangle);
        if (!material || !(brightness(mostEmitted(*material)) > 0)) continue;
        EmitterPart t = emissive(mesh, i, *material);
        if (!(t.area > 0)) continue;
        t.mesh = number;
        if (weight == EmitterWeight::shape) t.weight = 1;
        const auto owner = static_cast<std::uint64_t>(material - mesh.materials.data());
        found.push_back({t, hashWords(number, owner)});
    }
}

/// Corners of an area that shines, counter-clockwise around its middle.
std::vector<Vec3d> outlineOf(const Lamp& lamp) {
    const auto at = [&lamp](double x, double y) {
        return lamp.position + lamp.halfWidth * x + lamp.halfHeight * y;
    };
    if (lamp.form == Lamp::Form::rectangle) return {at(-1, -1), at(1, -1), at(1, 1), at(-1, 1)};
    constexpr double kStep = 2 * kPi / kEllipseSides;
    const double size = std::sqrt(kStep / std::sin(kStep));
    std::vector<Vec3d> outline;
    outline.reserve(kEllipseSides);
    for (int k = 0; k < kEllipseSides; ++k)
        outline.push_back(at(size * std::cos(k * kStep), size * std::sin(k * kStep)));
    return outline;
}

std::vector<EmitterPart> areaParts(const Lamp& lamp) {
    std::vector<EmitterPart> parts;
    const float slats =
        lamp.spread < kPi ? static_cast<float>(1 / std::tan(0.5 * lamp.spread)) : 0.0f;
    const std::vector<Vec3d> outline = outlineOf(lamp);
    float area = 0;
    for (std::size_t k = 0; k < outline.size(); ++k) {
        EmitterPart t = triangleOf({lamp.position, outline[k], outline[(k + 1) % outline.size()]});
        t.normal = Vec3f(lamp.direction);
        t.slats = slats;
        area += t.area;
        if (t.area > 0) parts.push_back(t);
    }
    for (EmitterPart& t : parts) t.radiance = lamp.strength * (1 / area);
    return parts;
}

EmitterPart pointPart(const Lamp& lamp) {
    EmitterPart part;
    part.form = EmitterPart::Form::point;
    part.centre = Vec3f(lamp.position);
    part.normal = Vec3f(lamp.direction);
    part.radius = static_cast<float>(lamp.radius);
    part.area = part.radius > 0 ? static_cast<float>(kPi * lamp.radius * lamp.radius) : 1;
    part.cone = lamp.cone;
    return part;
}

EmitterPart sunPart(const Lamp& lamp) {
    EmitterPart part;
    part.form = EmitterPart::Form::sun;
    part.normal = Vec3f(lamp.direction);
    const double sine = std::sin(0.5 * lamp.angle);
    part.sineSquared = static_cast<float>(sine * sine);
    part.area = part.sineSquared > 0 ? static_cast<float>(kPi * sine * sine) : 1;
    return part;
}

std::vector<EmitterPart> partsOf(const Lamp& lamp) {
    if (lamp.form == Lamp::Form::rectangle || lamp.form == Lamp::Form::ellipse)
        return areaParts(lamp);
    EmitterPart part = lamp.form == Lamp::Form::sun ? sunPart(lamp) : pointPart(lamp);
    part.radiance = lamp.strength * (1 / part.area);
    return {part};
}

}  // namespace

FoundParts findParts(std::span<const TriangleMesh* const> meshes, EmitterWeight weight) {
    FoundParts all;
    std::vector<FoundPart>& found = all.parts;
    for (std::uint32_t m = 0; m < meshes.size(); ++m) addSurfaces(*meshes[m], m, weight, found);
    if (weight == EmitterWeight::radiance) setVarying(meshes, all);
    for (std::uint32_t m = 0; m < meshes.size(); ++m)
        for (std::size_t i = 0; i < meshes[m]->lamps.size(); ++i) {
            const Lamp& lamp = meshes[m]->lamps[i];
            if (!(brightness(lamp.strength) > 0)) continue;
            if (lamp.moves && weight == EmitterWeight::shape) continue;
            for (EmitterPart& part : partsOf(lamp)) {
                part.mesh = m;
                part.lamp = static_cast<std::uint32_t>(i);
                part.moves = lamp.moves;
                part.seenByCamera = lamp.seenByCamera && part.hasExtent();
                part.radiance = part.radiance * lamp.gain;
                part.weight =
                    weight == EmitterWeight::shape ? 1 / part.area : brightness(part.radiance);
                found.push_back({part, hashWords(m, i, 1)});
            }
        }
    return all;
}

}  // namespace shadowcache
