// The zoo: small sets that programs read wrongly, with their right values.

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <optional>
#include <string>

#include "common/import/load_mesh.h"
#include "common/mesh/looks.h"
#include "common/mesh/mesh_fingerprint.h"
#include "common/mesh/placed_mesh.h"
#include "common/trace/scene.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/temporary_folder.h"

namespace shadowcache::test {
namespace {

struct SetCase {
    const char* file;
    std::size_t triangles;           ///< in the world
    std::optional<Vec3d> size{};     ///< of the set's box
    std::optional<Rgb> albedo{};     ///< of the first triangle, near its first corner
    std::string said{};              ///< in the report
    std::optional<double> height{};  ///< of the set's middle
};

const Rgb kRed(1, 0, 0), kOrange(1, 0.503f, 0), kBlue(0, 0, 1);
const Vec3d kSquareSize(2, 0, 2);

const SetCase kCases[] = {
    // glTF
    {"integers_as_floats_material.gltf", 4, kSquareSize, kRed},
    {"integers_as_floats_texture.gltf", 2, kSquareSize, kBlue},
    {"instances_optional.gltf", 6},
    {"instances_small_and_quantised.gltf", 4, Vec3d(0.04, 0, 0.02), kRed},
    {"instances_near_own_origin.gltf", 36, Vec3d(116, 1, 16)},
    {"instances_far_from_own_origin.gltf", 36, Vec3d(116, 1, 16)},
    {"morph_node_weight_1.gltf", 2, {}, {}, "", 1},
    {"morph_node_weight_0.gltf", 2, {}, {}, "", 0},
    {"specular_glossiness.gltf", 2, {}, kRed},
    {"no_scenes.gltf", 2},
    {"matrix_with_noise.gltf", 2, kSquareSize, kRed},
    {"chunk_without_bytes.glb", 2, kSquareSize, kRed},
    {"primitive_without_positions.gltf", 2, kSquareSize, kRed,
     "1 primitive whose positions are missing (left out)"},
    {"png_with_bytes_behind.gltf", 2, kSquareSize, kBlue},
    {"colors_by_blender.glb", 2, {}, Rgb(0.214f)},
    // OBJ
    {"byte_order_mark.obj", 2},
    {"colors_to_255.obj", 2, {}, kOrange},
    {"colors_by_blender.obj", 2, {}, Rgb(0.214f)},
    // PLY
    {"colors_of_type_int.ply", 2, {}, kOrange},
    {"colors_of_type_uchar.ply", 2, {}, kOrange},
    {"colors_white.ply", 2},
    // OFF
    {"counts_behind_keyword.off", 2},
    {"face_over_lines.off", 2},
    // STL
    {"upper_case.stl", 2},
    {"blank_before_solid.stl", 2},
    {"end_solid_of_two_words.stl", 2},
    {"no_end.stl", 2, {}, {}, "1 STL solids without 'endsolid', perhaps cut short"},
};

TriangleMesh loadCase(const std::string& name) {
    const std::filesystem::path path = std::filesystem::path(SHADOWCACHE_CASES) / name;
    return loadMesh({&path, 1}, {.gloss = true});
}

TEST(SetCases, HaveTheirValues) {
    for (const SetCase& c : kCases) {
        SCOPED_TRACE(c.file);
        const TriangleMesh mesh = loadCase(c.file);
        EXPECT_EQ(placedCount(mesh), c.triangles);
        const Box3d box = placedBounds(mesh);
        if (c.size) {
            EXPECT_NEAR((box.size() - *c.size).length(), 0, 1e-6 * c.size->length());
        }
        if (c.height) {
            EXPECT_NEAR(mesh.origin.y + box.center().y, *c.height, 1e-6);
        }
        if (c.albedo) {
            const Rgb found = albedoAt(mesh, 0, 0.2f, 0.2f, Rgb(0.5f));
            for (int k = 0; k < 3; ++k) EXPECT_NEAR(found[k], (*c.albedo)[k], 5e-4f) << found;
        }
        const std::string report = describe(mesh.report);
        EXPECT_NE(report.find(c.said), std::string::npos) << report;
    }
}

TEST(SetCases, ACacheKnowsWhichSidesAreSeen) {
    EXPECT_NE(fingerprint(loadCase("floor_single_sided.gltf")),
              fingerprint(loadCase("floor_double_sided.gltf")));
    EXPECT_EQ(fingerprint(loadCase("floor_double_sided.gltf")),
              fingerprint(loadCase("floor_double_sided.gltf")));
}

/// Open directions of 16 over places on all triangles, upwards.
std::vector<std::uint32_t> visibility(const TriangleMesh& mesh) {
    const Scene scene(mesh);
    std::vector<std::uint32_t> all;
    for (std::uint32_t t = 0; t < placedCount(mesh); ++t)
        for (int i = 0; i < 16; ++i) {
            const int row = i / 4, column = i % 4;
            const double u = 0.02 + 0.9 * column / 4, v = (0.98 - u) * (0.5 + row) / 4;
            const auto [a, b, c] = placedCorners(mesh, t);
            const Vec3f p(a + (b - a) * u + (c - a) * v);
            RayPacket rays{};
            for (int k = 0; k < 8; ++k)
                rays.set(
                    k, scene.rayOrigin(p, t, scene.normal(t)),
                    Vec3f(static_cast<float>(std::cos(k)), 0.4f, static_cast<float>(std::sin(k)))
                        .normalized());
            all.push_back(scene.visibility(rays, 8));
        }
    return all;
}

/// A mesh whose vertices lie 10 km from its own origin, and which nodes bring back.
TEST(SetCases, InstancesFarFromTheirOwnOriginSeeTheSame) {
    const auto near = visibility(loadCase("instances_near_own_origin.gltf"));
    const auto far = visibility(loadCase("instances_far_from_own_origin.gltf"));
    ASSERT_EQ(near.size(), far.size());
    std::size_t other = 0;
    for (std::size_t i = 0; i < near.size(); ++i) other += near[i] != far[i] ? 1 : 0;
    EXPECT_LE(other, near.size() / 100);
}

/// 4 mm below a slab of 1 m, in the middle of a floor of 10 km.
TEST(SetCases, RaysBeginBelowASlabNearALargeFloor) {
    const TriangleMesh mesh = loadCase("floor_of_5_km_below_slab.gltf");
    const Scene scene(mesh);
    for (const double x : {-0.4, -0.1, 0.0, 0.3})
        for (const double z : {-0.3, 0.05, 0.4}) {
            const Hit hit = scene.intersect(Vec3f(Vec3d(x, 0.001, z) - mesh.origin), {0, -1, 0});
            ASSERT_TRUE(hit.found);
            RayPacket rays{};
            rays.set(0, scene.rayOrigin(hit.position, hit.triangle, {0, 1, 0}), {0, 1, 0});
            EXPECT_EQ(scene.visibility(rays, 1), 0u);
        }
}

/// Corners of a comb as large as a hand where UTM has its numbers.
std::string utmComb(const std::string& more) {
    std::string obj;
    for (int i = 0; i < 20; ++i)
        for (const char* corner : {"0.00 4000001", "0.02 4000001", "0.02 3999999", "0.00 3999999"})
            obj += "v " + std::to_string(499999 + 0.02 * i + 0.01) + " " + corner + "\n";
    obj += "v 0 0 0\nv 0.1 0.2 0.3\nv 0.3 0.6 0.9\nv 1 1 0\n";
    for (int i = 0; i < 20; ++i) {
        obj += "f";
        for (int k = 1; k <= 4; ++k) obj += " " + std::to_string(4 * i + k);
        obj += "\n";
    }
    return obj + more;
}

TEST(SetCases, FacesThatAreDroppedMoveNoOrigin) {
    const TemporaryFolder folder;
    const auto loaded = [&](const std::string& more) {
        const auto path = folder.write("a.obj", utmComb(more));
        return loadMesh({&path, 1}, {});
    };
    const TriangleMesh plain = loaded("");
    for (const char* flat : {"f 81 81 81\n", "f 81 82 81\n", "f 81 82 83\n"}) {
        const TriangleMesh mesh = loaded(flat);
        EXPECT_EQ(mesh.origin, plain.origin) << flat;
        EXPECT_EQ(fingerprint(mesh), fingerprint(plain)) << flat;
        EXPECT_EQ(describe(mesh.report).find("precision"), std::string::npos);
    }
    // A real one does, and what is left is said: of 2 * 10^6 in float.
    const std::string text = describe(loaded("f 81 82 84\n").report);
    EXPECT_NE(text.find("positions there have a precision of 0.125, in the set's unit"),
              std::string::npos)
        << text;
}

/// A floor of 800 triangles, and some of a few micrometres at its corner.
std::string floorWithSpecks(int specks) {
    std::string obj;
    for (int i = 0; i <= 20; ++i)
        for (int k = 0; k <= 20; ++k) obj += fmt::format("v {} 0 {}\n", 0.5 * i, 0.5 * k);
    for (int i = 0; i < 20; ++i)
        for (int k = 0; k < 20; ++k) {
            const int a = 21 * i + k + 1;
            obj += fmt::format("f {} {} {} {}\n", a, a + 1, a + 22, a + 21);
        }
    for (int i = 0; i < specks; ++i)
        obj += fmt::format("v {0} 0 9\nv {0} 0.000005 9\nv {0} 0 9.000005\nf -3 -2 -1\n",
                           8 + 0.05 * i);
    return obj;
}

TEST(SetCases, AFewBlurredSpecksAreNotNamed) {
    const TemporaryFolder folder;
    const auto report = [&](const std::string& obj) {
        const auto path = folder.write("a.obj", obj);
        return describe(loadMesh({&path, 1}, {}).report);
    };
    EXPECT_EQ(report(floorWithSpecks(3)).find("blurred"), std::string::npos);
    // Many are, as something small that is to be seen.
    EXPECT_NE(report(floorWithSpecks(20)).find("20 triangles blurred"), std::string::npos);
}

/// A triangle, and two copies of another scale.
TEST(SetCases, InstancesThatAreTooSmallAreLeftOutByName) {
    const TemporaryFolder folder;
    const auto loaded = [&](double scale) {
        GltfBuilder file;
        file.mesh({{"attributes", {{"POSITION", file.vectors({0, 0, 0, 1, 0, 0, 0, 0, 1})}}}});
        file.root({{"mesh", 0}});
        for (const double x : {3.0, 5.0})
            file.root({{"mesh", 0}, {"translation", {x, 0, 0}}, {"scale", {scale, scale, scale}}});
        const auto path = folder.write("a.glb", file.glb());
        return loadMesh({&path, 1}, {});
    };
    const TriangleMesh whole = loaded(1e-5), without = loaded(1e-6);
    EXPECT_EQ(placedCount(whole), 3u);
    EXPECT_EQ(placedCount(without), 1u);
    EXPECT_EQ(describe(whole.report).find("scale is below"), std::string::npos);
    EXPECT_NE(describe(without.report).find("2 instances whose scale is below 2e-6 (left out)"),
              std::string::npos)
        << describe(without.report);
}

}  // namespace
}  // namespace shadowcache::test
