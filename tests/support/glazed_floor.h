#pragma once

#include <cmath>

#include "tests/support/test_scenes.h"

namespace shadowcache::test {

/// Smooth glass that transmits, of index 1.5.
inline Material glass(const Rgb& color, float transmission = 1) {
    Material pane;
    pane.albedo = color;
    pane.finish.gloss = Gloss{.metallic = 0, .roughness = 0};
    pane.finish.transmission = transmission;
    return pane;
}

/// What clear glass lets pass of light in a direction. [Schlick 1994]
inline double passed(double cosine) {
    return 0.96 * (1 - std::pow(1 - std::abs(cosine), 5));
}

/// A floor that emits nothing, and level sheets of glass above it: instances of one that is turned
/// and stretched, or there themselves.
inline TriangleMesh glazedFloor(int sheets, const Material& pane, bool shared = false) {
    TriangleMesh mesh;
    addFloor(mesh, 0, -1, 1, -1, 1);
    const int copies = shared ? 1 : sheets;
    for (int k = 0; k < copies; ++k) {
        const float y = 1 + 0.1f * static_cast<float>(k);
        if (shared)  // upright, a quarter as wide
            addQuad(mesh, {0, -3, -0.75f}, {0, 3, -0.75f}, {0, 3, 0.75f}, {0, -3, 0.75f});
        else
            addFloor(mesh, y, -3, 3, -3, 3);
    }
    mesh.materials = {Material{}, pane};
    mesh.materials[0].albedo = Rgb(0.5f);
    mesh.parts = {{0, 2, 0}, {2, static_cast<std::uint32_t>(2 * copies), 1}};
    if (!shared) return mesh;
    mesh.firstSharedPart = 1;
    for (int k = 0; k < sheets; ++k) {
        MeshInstance sheet;
        sheet.firstPart = sheet.partCount = 1;
        sheet.toWorld.axis = {Vec3d(0, 1, 0), Vec3d(-1, 0, 0), Vec3d(0, 0, 4)};
        sheet.toWorld.position = {0, 1 + 0.1 * k, 0};
        sheet.firstPlaced = static_cast<std::uint32_t>(2 + 2 * k);
        sheet.triangleCount = 2;
        mesh.instances.push_back(sheet);
    }
    return mesh;
}

}  // namespace shadowcache::test
