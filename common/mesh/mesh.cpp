#include "common/mesh/mesh.h"

namespace shadowcache {

std::string describe(const MeshReport& report) {
    std::string text = std::to_string(report.triangles) + " triangles";
    const auto add = [&](std::size_t count, const std::string& what) {
        if (count > 0) text += "; " + std::to_string(count) + " " + what;
    };
    add(report.polygons,
        "n-gons cut into " + std::to_string(report.trianglesFromPolygons) + " triangles");
    add(report.badVertexFaces, "dropped for a bad vertex (NaN, Inf or out of range)");
    add(report.degenerate, "without area dropped");
    add(report.duplicates, "duplicates kept");
    add(report.nonManifoldEdges, "non-manifold edges");
    add(report.mixedWinding, "edges of mixed winding");
    add(report.unreferenced, "vertices without a face");
    add(report.badNormals, "shading normals that are zero, not finite or out of range");
    add(report.blended, "blending materials, which let rays pass by chance");
    for (const auto& [name, count] : report.leftOut)
        add(count, (count == 1 ? "material without its " : "materials without their ") + name +
                       ", which is left out");
    for (const auto& [thing, count] : report.leftOutOf) {
        const auto& [kind, cause] = thing;
        const char* plural = kind == "mesh" ? "es" : "s";
        add(count, kind + (count == 1 ? "" : plural) + " whose " + cause);
    }
    add(report.instances,
        "instances, with which " + std::to_string(report.placed) + " triangles are in the world");
    return text;
}

}  // namespace shadowcache
