// Normal maps, through every way to a basis.

#include "common/mesh/normal_map.h"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "common/image/image.h"
#include "common/image/png.h"
#include "common/image/srgb.h"
#include "common/import/load_mesh.h"
#include "common/mesh/placed_mesh.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/temporary_folder.h"

namespace shadowcache::test {
namespace {

using Json = nlohmann::json;

TriangleMesh loadShaded(const GltfBuilder& file, bool shadingNormals = true) {
    const TemporaryFolder folder;
    const auto path = folder.write("a.glb", file.glb());
    MeshOptions options;
    options.shadingNormals = shadingNormals;
    return loadMesh({&path, 1}, options);
}

/// The map's normal, before it is stored in 8 bits.
const Vec3d kBent = Vec3d(0.5, 0.25, 0.75).normalized();

/// A map of one normal.
std::string mapOf(const Vec3d& normal) {
    Rgb texel;
    // writePng() encodes sRGB, and the texture holds what is stored.
    for (int k = 0; k < 3; ++k) texel[k] = srgbToLinear(static_cast<float>((normal[k] + 1) / 2));
    const TemporaryFolder folder;
    writePng(folder.path() / "a.png", {1, 1, {texel}}, 0);
    return readBytes(folder.path() / "a.png");
}

/// What of the basis the file tells.
struct Given {
    bool normals = true;
    bool tangents = false;
};

/// The square; in its texture s grows along y and t along x, so that up in the picture is -x.
GltfBuilder mappedSquare(const Given& given, double scale = 1) {
    GltfBuilder file;
    const std::vector<float> up{0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1};
    Json attributes{
        {"POSITION", file.vectors(kSquare)},
        {"TEXCOORD_0", file.accessor(std::vector<float>{0, 0, 0, 1, 1, 1, 1, 0}, "VEC2", 2)}};
    if (given.normals) attributes["NORMAL"] = file.vectors(up);
    // normal x tangent = z x y = -x, which is up in the picture.
    const std::vector<float> along{0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1};
    if (given.tangents) attributes["TANGENT"] = file.accessor(along, "VEC4", 4);
    const int image =
        file.append("images", {{"bufferView", file.view(mapOf(kBent))}, {"mimeType", "image/png"}});
    file.append("textures", {{"source", image}});
    file.append("materials", {{"normalTexture", {{"index", 0}, {"scale", scale}}}});
    file.mesh({{"attributes", attributes},
               {"indices", file.accessor(kSquareIndices, "SCALAR", 1)},
               {"material", 0}});
    return file;
}

/// That map in the world, for a square that is not turned.
const Vec3d kWanted(-kBent.y, kBent.x, kBent.z);

/// Normal on the side of `side`.
Vec3d normalOf(const TriangleMesh& mesh, std::uint32_t number, const Vec3d& side) {
    const Vec3f n(side);
    return Vec3d(mappedNormal(mesh, number, 0.3f, 0.2f, n, n));
}

/// 8 bits tell no more.
constexpr double kStored = 0.01;

void expectNear(const Vec3d& found, const Vec3d& wanted) {
    EXPECT_LT((found - wanted).length(), kStored) << found << " for " << wanted;
    EXPECT_NEAR(found.length(), 1, 1e-6);
}

TEST(NormalMap, IsTheSameThroughEveryBasis) {
    for (const Given& given : {Given{true, true}, Given{true, false}, Given{false, false}}) {
        SCOPED_TRACE(given.normals ? (given.tangents ? "tangents" : "normals") : "nothing");
        GltfBuilder file = mappedSquare(given);
        file.root({{"mesh", 0}});
        const TriangleMesh mesh = loadShaded(file);
        EXPECT_EQ(mesh.tangents.empty(), !given.normals);
        for (const std::uint32_t triangle : {0u, 1u})
            expectNear(normalOf(mesh, triangle, Vec3d(0, 0, 1)), kWanted);
        // From behind, hills are valleys.
        expectNear(normalOf(mesh, 0, Vec3d(0, 0, -1)), -kWanted);
    }
}

// A mirror image of the mesh is one of its relief, as an instance and on its own.
TEST(NormalMap, OfMirroredAndTurnedNodes) {
    for (const Given& given : {Given{true, true}, Given{true, false}, Given{false, false}})
        for (const bool shared : {false, true}) {
            SCOPED_TRACE(fmt::format("{:d}{:d}{:d}", given.normals, given.tangents, shared));
            GltfBuilder file = mappedSquare(given);
            file.root({{"mesh", 0}, {"scale", {-2, 2, 2}}});
            if (shared)  // a quarter turn about x: y to z, z to -y
                file.root({{"mesh", 0}, {"rotation", {std::sqrt(0.5), 0, 0, std::sqrt(0.5)}}});
            const TriangleMesh mesh = loadShaded(file);
            expectNear(normalOf(mesh, 0, Vec3d(0, 0, 1)), {-kWanted.x, kWanted.y, kWanted.z});
            if (!shared) continue;
            expectNear(normalOf(mesh, 2, Vec3d(0, -1, 0)), {kWanted.x, -kWanted.z, kWanted.y});
        }
}

TEST(NormalMap, ScalesWhatLiesAlongTheSurface) {
    GltfBuilder file = mappedSquare({true, false}, 0.5);
    file.root({{"mesh", 0}});
    expectNear(normalOf(loadShaded(file), 0, Vec3d(0, 0, 1)),
               Vec3d(kWanted.x / 2, kWanted.y / 2, kWanted.z).normalized());
}

TEST(NormalMap, TurnsWithTheFilesAxes) {
    GltfBuilder file = mappedSquare({true, true});
    file.root({{"mesh", 0}});
    const TemporaryFolder folder;
    const auto path = folder.write("a.glb", file.glb());
    MeshOptions options;
    options.shadingNormals = options.zUp = true;
    options.scale = 3;
    // z becomes y, y becomes -z.
    expectNear(normalOf(loadMesh({&path, 1}, options), 0, Vec3d(0, 1, 0)),
               {kWanted.x, kWanted.z, -kWanted.y});
}

// Where a triangle has no area in the texture, a tangent is zero or not finite, or the normals are
// geometric, nothing is bent.
TEST(NormalMap, WithoutABasisBendsNothing) {
    const Vec3d up(0, 0, 1);
    GltfBuilder flat = mappedSquare({true, false});
    flat.json["meshes"][0]["primitives"][0]["attributes"].erase("TEXCOORD_0");
    flat.root({{"mesh", 0}});
    EXPECT_EQ(normalOf(loadShaded(flat), 0, up), up);
    GltfBuilder whole = mappedSquare({true, true});
    whole.root({{"mesh", 0}});
    EXPECT_EQ(normalOf(loadShaded(whole, false), 0, up), up);
    const float nan = std::nanf("");
    for (const float bad : {0.0f, nan}) {
        GltfBuilder file = mappedSquare({true, false});
        file.json["meshes"][0]["primitives"][0]["attributes"]["TANGENT"] = file.accessor(
            std::vector<float>{bad, 0, 0, 1, bad, 0, 0, 1, bad, 0, 0, 1, bad, 0, 0, 1}, "VEC4", 4);
        file.root({{"mesh", 0}});
        // The texture coordinates stand in.
        expectNear(normalOf(loadShaded(file), 0, up), kWanted);
    }
}

TEST(NormalMap, OfAWrongSizeIsRefused) {
    const TemporaryFolder folder;
    GltfBuilder file = mappedSquare({true, false});
    file.json["meshes"][0]["primitives"][0]["attributes"]["TANGENT"] =
        file.vectors({1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0});
    file.root({{"mesh", 0}});
    const auto path = folder.write("a.glb", file.glb());
    expectError([&] { loadMesh({&path, 1}, {}); }, "a.glb", "TANGENT does not match");
}

}  // namespace
}  // namespace shadowcache::test
