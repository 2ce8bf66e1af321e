#include "common/mesh/mesh.h"

#include <fmt/core.h>

#include <cctype>

namespace shadowcache {

namespace {

/// Of what is left out; the others are counted.
constexpr std::size_t kMostNames = 20;

/// A name from a file in one line of a terminal.
std::string printable(std::string name) {
    for (char& c : name)
        if (std::iscntrl(static_cast<unsigned char>(c))) c = '?';
    return name;
}

}  // namespace

std::string describe(const MeshReport& report) {
    std::string text = fmt::format("{} triangles", report.triangles);
    const auto add = [&](std::size_t count, const std::string& what) {
        if (count > 0) text += fmt::format("; {} {}", count, what);
    };
    add(report.polygons, fmt::format("n-gons cut into {} triangles", report.trianglesFromPolygons));
    add(report.badVertexFaces, "dropped for a bad vertex (NaN, Inf or out of range)");
    add(report.degenerate, "without area dropped");
    add(report.duplicates, "duplicates kept");
    add(report.nonManifoldEdges, "non-manifold edges");
    add(report.mixedWinding, "edges of mixed winding");
    add(report.unreferenced, "vertices without a face");
    add(report.badNormals, "shading normals that are zero, not finite or out of range");
    add(report.badColors, "vertex colours out of range or not finite, clamped");
    for (const auto& [remark, count] : report.remarks) add(count, remark);
    add(report.blended, "blending materials, which let rays pass by chance");
    std::size_t named = 0;
    for (const auto& [name, count] : report.leftOut)
        if (named++ < kMostNames)
            add(count, (count == 1 ? "material without its " : "materials without their ") +
                           printable(name) + ", which is left out");
    if (named > kMostNames) add(named - kMostNames, "other things left out");
    for (const auto& [thing, count] : report.leftOutOf) {
        const auto& [kind, cause] = thing;
        const char* plural = kind == "mesh" ? "es" : "s";
        add(count, kind + (count == 1 ? "" : plural) + " whose " + cause);
    }
    add(report.instances,
        fmt::format("instances, with which {} triangles are in the world", report.placed));
    return text;
}

}  // namespace shadowcache
