// What the libraries of materials of OBJ files become.

#include <gtest/gtest.h>

#include <cmath>

#include "common/image/png.h"
#include "common/image/srgb.h"
#include "common/import/load_mesh.h"
#include "common/import/mesh_reader.h"
#include "common/import/set_files.h"
#include "common/mesh/looks.h"
#include "common/mesh/normal_map.h"
#include "tests/support/temporary_folder.h"

namespace shadowcache::test {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSquareOfTexcoords =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";

class ObjMaterial : public testing::Test {
protected:
    /// The square with one material, `lines` of the library.
    TriangleMesh square(const std::string& lines) {
        folder_.write("a.mtl", "newmtl one\n" + lines);
        return load(kSquareOfTexcoords +
                    std::string("mtllib a.mtl\nusemtl one\nf 1/1 2/2 3/3\nf 1/1 3/3 4/4\n"));
    }

    TriangleMesh load(const std::string& obj, References references = References::inside) {
        const fs::path path = folder_.write("a.obj", obj);
        MeshOptions options;
        options.gloss = options.shadingNormals = true;
        options.references = references;
        return loadMesh({&path, 1}, options);
    }

    /// A picture of 2 x 2 texels, rows from the top.
    void picture(const std::string& name, const std::array<Rgb, 4>& texels) {
        writePng(folder_.path() / name, {2, 2, {texels.begin(), texels.end()}}, 0);
    }

    std::size_t leftOut(const TriangleMesh& mesh, const std::string& name) const {
        const auto found = mesh.report.leftOut.find(name);
        return found == mesh.report.leftOut.end() ? 0 : found->second;
    }

    TemporaryFolder folder_;
};

const Rgb kBlack(0.0f), kWhite(1.0f), kRed(1, 0, 0), kGreen(0, 1, 0), kBlue(0, 0, 1);

/// At (x, y) of the square, of triangles (0,0) (1,0) (1,1) and (0,0) (1,1) (0,1).
Surface squareAt(const TriangleMesh& mesh, float x, float y) {
    return y <= x ? surfaceAt(mesh, 0, x - y, y, {}) : surfaceAt(mesh, 1, x, y - x, {});
}

void expectColor(const Rgb& found, const Rgb& wanted) {
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(found[k], wanted[k], 1e-3f) << found << wanted;
}

TEST_F(ObjMaterial, ColorsStandAsTheyAre) {
    const TriangleMesh mesh = square("Kd .5 .25 1 # a comment\nKa 1 1 1\nillum 1\n");
    EXPECT_EQ(mesh.materials.at(0).albedo, Rgb(0.5f, 0.25f, 1.0f));
    EXPECT_FALSE(mesh.materials[0].finish.gloss);
    EXPECT_FALSE(mesh.materials[0].blends);
    EXPECT_TRUE(mesh.report.leftOut.empty()) << describe(mesh.report);
    expectColor(square("kd .3\n").materials.at(0).albedo, Rgb(0.3f));
}

TEST_F(ObjMaterial, PicturesHaveTheirFirstRowOnTop) {
    picture("four.png", {kRed, kGreen, kBlue, kWhite});
    const TriangleMesh mesh = square("Kd .5 .5 .5\nmap_Kd four.png\n");
    expectColor(squareAt(mesh, 0.25f, 0.75f).baseColor, kRed * 0.5f);
    expectColor(squareAt(mesh, 0.75f, 0.75f).baseColor, kGreen * 0.5f);
    expectColor(squareAt(mesh, 0.25f, 0.25f).baseColor, kBlue * 0.5f);
    // Black beside a picture is none.
    expectColor(squareAt(square("Kd 0 0 0\nmap_Kd four.png\n"), 0.25f, 0.75f).baseColor, kRed);
}

TEST_F(ObjMaterial, OptionsOfPictures) {
    picture("four image.png", {kRed, kGreen, kBlue, kWhite});
    const auto corner = [&](const std::string& options) {
        return squareAt(square("map_Kd " + options + " four image.png\n"), 0.25f, 0.25f).baseColor;
    };
    expectColor(corner(""), kBlue);
    expectColor(corner("-o .5 0 0"), kWhite);
    expectColor(corner("-o 0 .5"), kRed);
    expectColor(corner("-s 3 3 1"), kGreen);
}

TEST_F(ObjMaterial, ClampedPicturesDoNotRepeat) {
    picture("four.png", {kRed, kGreen, kBlue, kWhite});
    EXPECT_EQ(square("map_Kd -clamp on four.png\n").textures.at(0).wrapS, Texture::Wrap::clamp);
    const TriangleMesh mesh = square("map_Kd -mm 0 2 -bm 2 -clamp off four.png\n");
    EXPECT_EQ(mesh.textures.at(0).wrapS, Texture::Wrap::repeat);
    EXPECT_EQ(leftOut(mesh, "map_Kd -mm"), 1u);
    EXPECT_EQ(leftOut(mesh, "map_Kd -bm"), 1u);
}

TEST_F(ObjMaterial, OpacityByNumberAndPicture) {
    EXPECT_FLOAT_EQ(square("d .25\n").materials.at(0).opacity, 0.25f);
    EXPECT_FLOAT_EQ(square("Tr .25\n").materials.at(0).opacity, 0.75f);
    // d is what both say where they differ.
    EXPECT_FLOAT_EQ(square("d .25\nTr .25\n").materials.at(0).opacity, 0.25f);
    EXPECT_FLOAT_EQ(square("Tr .25\nd .25\n").materials.at(0).opacity, 0.25f);
    picture("leaf.png", {kWhite, kBlack, kWhite, kWhite});
    picture("color.png", {kRed, kRed, kRed, kRed});
    const TriangleMesh mesh = square("map_Kd color.png\nmap_d leaf.png\n");
    const Material& material = mesh.materials.at(0);
    EXPECT_TRUE(material.blends);
    EXPECT_EQ(mesh.report.blended, 1u);
    EXPECT_LT(opacityAt(mesh, material, 0, 0, 0.75f), 0.5f);     // (.75, .75): black
    EXPECT_GT(opacityAt(mesh, material, 0, 0.5f, 0.25f), 0.5f);  // (.75, .25): white
    expectColor(squareAt(mesh, 0.75f, 0.25f).baseColor, kRed);
}

TEST_F(ObjMaterial, GlossOfBothKinds) {
    const Gloss old = *square("Ks .5 .5 .5\nNs 250\n").materials.at(0).finish.gloss;
    EXPECT_NEAR(old.roughness, 0.5f, 1e-6f);  // as Blender writes and reads it
    EXPECT_NEAR(old.specularColor.x, 1.0f, 1e-6f);
    EXPECT_EQ(old.metallic, 0.0f);
    EXPECT_FALSE(square("Ks 0 0 0\nNs 250\n").materials.at(0).finish.gloss);
    EXPECT_FALSE(square("Ks 1 1 1\nNs 250\nillum 1\n").materials.at(0).finish.gloss);
    const Gloss physical = *square("Pr .3\nPm 1\nNs 250\n").materials.at(0).finish.gloss;
    EXPECT_EQ(physical.roughness, 0.3f);
    EXPECT_EQ(physical.metallic, 1.0f);
    picture("rough.png", {kWhite, kWhite, kBlack, kBlack});
    picture("metal.png", {kBlack, kWhite, kBlack, kWhite});
    const TriangleMesh mesh = square("map_Pr rough.png\nmap_Pm metal.png\n");
    const TextureSlot slot = mesh.materials.at(0).finish.metallicRoughness;
    const auto lowerRight = textureAt(mesh, 0, 0.5f, 0.25f, slot);
    EXPECT_NEAR(lowerRight[1], 0.0f, 1e-3f);
    EXPECT_NEAR(lowerRight[2], 1.0f, 1e-3f);
}

TEST_F(ObjMaterial, EmissionIsRead) {
    picture("four.png", {kRed, kGreen, kBlue, kWhite});
    expectColor(squareAt(square("Ke 2 3 4\n"), 0.5f, 0.5f).emission, Rgb(2, 3, 4));
    expectColor(squareAt(square("Ke 2 2 2\nmap_Ke four.png\n"), 0.25f, 0.75f).emission,
                kRed * 2.0f);
}

TEST_F(ObjMaterial, FacesHaveTheMaterialInForce) {
    folder_.write("a.mtl", "newmtl red\nKd 1 0 0\nnewmtl a blue one\nKd 0 0 1\n");
    const TriangleMesh mesh = load(std::string(kSquareOfTexcoords) +
                                   "mtllib a.mtl\nf 1 2 3\nusemtl a blue one\nf 1 3 4\n"
                                   "usemtl red\nf 2 3 4\nf 1 2 4\nusemtl a blue one\nf 1 2 3 4\n");
    std::map<int, std::uint32_t> count;
    for (const MeshPart& part : mesh.parts) count[part.material] += part.triangleCount;
    ASSERT_EQ(mesh.materials.size(), 2u);
    EXPECT_EQ(mesh.materials[0].albedo, kBlue);
    EXPECT_EQ(mesh.materials[1].albedo, kRed);
    const std::map<int, std::uint32_t> wanted{{-1, 1}, {0, 3}, {1, 2}};
    EXPECT_EQ(count, wanted);
}

/// Two faces that meet in an edge and lie at other places of the picture there.
TEST_F(ObjMaterial, SeamsSplitVertices) {
    picture("four.png", {kRed, kGreen, kBlue, kWhite});
    folder_.write("a.mtl", "newmtl one\nmap_Kd four.png\n");
    const TriangleMesh mesh =
        load(std::string(kSquareOfTexcoords) +
             "vt .75 .75\nmtllib a.mtl\nusemtl one\nf 1/1 2/2 3/3\nf 1/5 3/5 4/5\n");
    EXPECT_EQ(mesh.positions.size(), 6u);
    expectColor(squareAt(mesh, 0.25f, 0.75f).baseColor, kGreen);
    expectColor(squareAt(mesh, 0.75f, 0.25f).baseColor, kWhite);
    EXPECT_EQ(mesh.report.nonManifoldEdges, 0u);
}

TEST_F(ObjMaterial, ColoursOfVerticesStandForKd) {
    folder_.write("a.mtl", "newmtl one\nKd .5 .5 .5\n");
    const auto albedo = [&](const char* color) {
        std::string obj = "mtllib a.mtl\nusemtl one\n";
        for (const char* corner : {"0 0 0", "1 0 0", "1 1 0"})
            obj += "v " + std::string(corner) + color + "\n";
        return load(obj + "f 1 2 3\n").materials.at(0).albedo;
    };
    EXPECT_EQ(albedo(""), Rgb(0.5f));
    EXPECT_EQ(albedo(" 1 0 0"), kWhite);
}

TEST_F(ObjMaterial, WhatIsMissingIsNamed) {
    const TriangleMesh mesh =
        load(std::string(kSquareOfTexcoords) + "mtllib none.mtl\nusemtl one\nf 1 2 3\nf 1 3 4\n");
    EXPECT_EQ(mesh.triangles.size(), 2u);
    EXPECT_EQ(leftOut(mesh, "none.mtl (no such file)"), 1u);
    EXPECT_EQ(leftOut(mesh, "definition of one (in no library)"), 1u);
    folder_.write("old.tga", "no picture that is read");
    const TriangleMesh pictures = square("map_Kd none.png\nmap_Ke old.tga\nKe 1 1 1\n");
    EXPECT_EQ(leftOut(pictures, "none.png (no such file)"), 1u);
    EXPECT_EQ(leftOut(pictures, "old.tga (no whole PNG, JPEG or WebP)"), 1u);
    EXPECT_EQ(pictures.materials.at(0).texture, -1);
}

TEST_F(ObjMaterial, WhatIsLeftOutIsNamedOnce) {
    const TriangleMesh mesh = square(
        "map_Bump bump.png\nmap_Bump bump.png\nillum 7\nTf .5 .5 .5\nPc 1\nPs 0\n"
        "Ni 1.5\nfoo 1 2 3\nKd spectral file.rfl\nd -halo .5\n");
    for (const char* name :
         {"map_Bump", "refraction (illum 7)", "Tf", "Pc", "foo", "Kd spectral", "d -halo"})
        EXPECT_EQ(leftOut(mesh, name), 1u) << name;
    EXPECT_EQ(mesh.report.leftOut.size(), 7u) << describe(mesh.report);
    EXPECT_NE(describe(mesh.report).find("material without its map_Bump"), std::string::npos);
}

TEST_F(ObjMaterial, KindsOfLightThatAreNotReadAreNamed) {
    EXPECT_EQ(leftOut(square("Kd 1 1 1\nillum 0\n"), "constant colour (illum 0)"), 1u);
    EXPECT_EQ(leftOut(square("Kd 1 1 1\nillum 10\n"), "being but its shadow (illum 10)"), 1u);
    for (const char* kind : {"1", "2", "3", "5", "8"})
        EXPECT_TRUE(square(std::string("Kd 1 1 1\nillum ") + kind).report.leftOut.empty()) << kind;
}

TEST_F(ObjMaterial, NumbersOfPicturesOutOfRangeAreNamed) {
    picture("all.png", {kRed, kGreen, kBlue, kWhite});
    const TriangleMesh far = square("map_Kd -o 1e7 0 0 -s 1 1e6 all.png\n");
    EXPECT_EQ(leftOut(far, "map_Kd -o (out of range)"), 1u);
    EXPECT_EQ(leftOut(far, "map_Kd -s (out of range)"), 1u);
    EXPECT_TRUE(square("map_Kd -o 99 0 1e9 -s 1 1e5 all.png\n").report.leftOut.empty());
}

TEST_F(ObjMaterial, WhatIsDamagedIsLeftOut) {
    picture("whole.png", {kRed, kGreen, kBlue, kWhite});
    folder_.write("cut.png", readBytes(folder_.path() / "whole.png").substr(0, 40));
    const TriangleMesh cut = square("map_Kd cut.png\nKd .25 .5 1\n");
    EXPECT_EQ(leftOut(cut, "cut.png (no whole PNG, JPEG or WebP)"), 1u);
    EXPECT_EQ(cut.materials.at(0).albedo, Rgb(0.25f, 0.5f, 1));
    // Numbers out of range are brought into it.
    const Material material = square("Kd 5 -1 nan\nPr 7\nd -2\n").materials.at(0);
    EXPECT_EQ(material.albedo, Rgb(1, 0, 0));
    EXPECT_EQ(material.opacity, 0.0f);
}

TEST_F(ObjMaterial, LinesThatCannotBeReadAreNamed) {
    const TriangleMesh mesh =
        square("Kd .5 .25 1\nmap_Kd\nmap_d \nNs\nNs x\nKs 1 x 1\nillum 1.0\nPr\nillum -1\nd\n");
    for (const char* name : {"map_Kd (without a file's name)", "map_d (without a file's name)",
                             "Ns (not as expected)", "Ks (not as expected)", "Pr (not as expected)",
                             "illum (not as expected)", "d (not as expected)"})
        EXPECT_EQ(leftOut(mesh, name), 1u) << name << ": " << describe(mesh.report);
    EXPECT_EQ(mesh.report.leftOut.size(), 7u);
    EXPECT_EQ(mesh.materials.at(0).albedo, Rgb(0.5f, 0.25f, 1.0f));
    EXPECT_FALSE(square("Ks 1 1 1\nillum 1.0\n").materials.at(0).finish.gloss);
    EXPECT_TRUE(square("Ks 1 1 1\nillum 2e0\n").materials.at(0).finish.gloss);
    folder_.write("b.mtl", "Kd 1 1 1\nNs 5\nnewmtl one\nKd 0 1 0\n");
    const TriangleMesh early =
        load(std::string(kSquareOfTexcoords) + "mtllib b.mtl\nusemtl one\nf 1 2 3\n");
    EXPECT_EQ(leftOut(early, "Kd (before newmtl)"), 1u);
    EXPECT_EQ(early.materials.at(0).albedo, kGreen);
}

/// MeshLab before 2023, openMVS and mvs-texturing write it for opaque.
TEST_F(ObjMaterial, Tr1AloneIsOpaqueAndNamed) {
    const TriangleMesh mesh = square("Kd 0 1 0\nTr 1.000000\nillum 2\n");
    EXPECT_EQ(mesh.materials.at(0).opacity, 1.0f);
    EXPECT_FALSE(mesh.materials[0].blends);
    EXPECT_EQ(leftOut(mesh, "Tr 1 (without d beside it: taken for opaque)"), 1u);
    EXPECT_EQ(square("Tr 0\n").materials.at(0).opacity, 1.0f);
    const TriangleMesh gone = square("Tr 1\nd 0\n");
    EXPECT_EQ(gone.materials.at(0).opacity, 0.0f);
    EXPECT_NE(describe(gone.report)
                  .find("1 material whose opacity is 0, so that nothing of it is seen: one"),
              std::string::npos)
        << describe(gone.report);
}

/// Whole parts of texture coordinates say nothing, however far out; but for pictures that end.
TEST_F(ObjMaterial, PicturesFarOutAreAsNearby) {
    picture("four.png", {kRed, kGreen, kBlue, kWhite});
    const auto far = [&](const std::string& lines, double s, double t) {
        folder_.write("a.mtl", "newmtl one\n" + lines);
        std::string obj = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
        for (const auto& [u, v] : {std::pair(0, 0), {1, 0}, {1, 1}, {0, 1}})
            obj += "vt " + std::to_string(s + u) + " " + std::to_string(t + v) + "\n";
        // Another island, near 0.
        obj += "v 5 0 0\nv 6 0 0\nv 6 1 0\nvt 0 0\nvt 1 0\nvt 1 1\n";
        return load(obj +
                    "mtllib a.mtl\nusemtl one\nf 1/1 2/2 3/3\nf 1/1 3/3 4/4\nf 5/5 6/6 7/7\n");
    };
    for (const auto& [s, t] :
         {std::pair(4e6, 4e6), {-123456789.0, 1e12}, {1e5, -3e7}, {0.0, 0.0}}) {
        SCOPED_TRACE(s);
        const TriangleMesh mesh = far("map_Kd four.png\n", s, t);
        expectColor(squareAt(mesh, 0.25f, 0.75f).baseColor, kRed);
        expectColor(squareAt(mesh, 0.75f, 0.75f).baseColor, kGreen);
        expectColor(squareAt(mesh, 0.25f, 0.25f).baseColor, kBlue);
        expectColor(squareAt(mesh, 0.75f, 0.25f).baseColor, kWhite);
        expectColor(surfaceAt(mesh, 2, 0.5f, 0.25f, {}).baseColor, kWhite);
    }
    // Of one that ends, the last texel goes on.
    expectColor(squareAt(far("map_Kd -clamp on four.png\n", 4e6, 4e6), 0.25f, 0.25f).baseColor,
                kGreen);
    expectColor(squareAt(far("map_Kd -clamp on four.png\n", -4e6, -4e6), 0.25f, 0.25f).baseColor,
                kBlue);
}

TEST_F(ObjMaterial, PlusInANameIsAPlus) {
    picture("oak+pine.png", {kRed, kRed, kRed, kRed});
    picture("oak pine.png", {kBlue, kBlue, kBlue, kBlue});
    EXPECT_EQ(squareAt(square("map_Kd oak+pine.png\n"), 0.5f, 0.5f).baseColor, kRed);
}

TEST_F(ObjMaterial, OptionsAtTheirDefaultsAreNotNamed) {
    picture("four.png", {kRed, kGreen, kBlue, kWhite});
    const TriangleMesh mesh = square(
        "map_Kd -blendu off -blendv on -bm 1.0 -boost 0 -cc off -mm 0 1 -t 0 0 0 -texres 512 "
        "four.png\n");
    EXPECT_TRUE(mesh.report.leftOut.empty()) << describe(mesh.report);
    expectColor(squareAt(mesh, 0.25f, 0.75f).baseColor, kRed);
}

/// Green points to the upper edge of the picture, as in glTF; -bm scales.
TEST_F(ObjMaterial, NormalMapsBendTheNormal) {
    const Vec3d bent = Vec3d(0.5, 0.25, 0.75).normalized();
    Rgb texel;  // writePng() encodes sRGB, and the texture holds what is stored
    for (int k = 0; k < 3; ++k) texel[k] = srgbToLinear(static_cast<float>((bent[k] + 1) / 2));
    picture("n.png", {texel, texel, texel, texel});
    const auto found = [&](const std::string& line) {
        const TriangleMesh mesh = square(line);
        EXPECT_TRUE(mesh.report.leftOut.empty()) << describe(mesh.report);
        const Vec3f up(0, 0, 1);
        return Vec3d(mappedNormal(mesh, 0, 0.3f, 0.2f, up, up));
    };
    EXPECT_LT((found("norm n.png\n") - bent).length(), 0.01);
    const Vec3d twice = Vec3d(2 * bent.x, 2 * bent.y, bent.z).normalized();
    EXPECT_LT((found("norm -bm 2 n.png\n") - twice).length(), 0.01);
    // Beside a colour that lies elsewhere, and turned over where the picture is.
    picture("four.png", {kRed, kGreen, kBlue, kWhite});
    EXPECT_LT((found("map_Kd -s 2 2 four.png\nnorm n.png\n") - bent).length(), 0.01);
    const Vec3d turned(-bent.x, bent.y, bent.z);
    EXPECT_LT((found("norm -s -1 1 n.png\n") - turned).length(), 0.01);
}

/// Triangles that share corners and their normals share the basis there, whatever their own is.
TEST_F(ObjMaterial, NormalMapsAreSmoothWhereNormalsAre) {
    const Vec3d bent = Vec3d(0.6, 0, 0.8);
    Rgb texel;
    for (int k = 0; k < 3; ++k) texel[k] = srgbToLinear(static_cast<float>((bent[k] + 1) / 2));
    picture("n.png", {texel, texel, texel, texel});
    folder_.write("a.mtl", "newmtl one\nnorm n.png\n");
    const auto step = [&](const std::string& faces) {
        const TriangleMesh mesh = load(
            "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 0.5\n"
            "vn 0 0 1\nvn 0 0 2\nmtllib a.mtl\nusemtl one\n" +
            faces);
        EXPECT_EQ(mesh.triangles.size(), 2u);
        const Vec3f up(0, 0, 1);
        return Vec3d(mappedNormal(mesh, 0, 0, 0.4f, up, up) -
                     mappedNormal(mesh, 1, 0.4f, 0, up, up))
            .length();
    };
    EXPECT_LT(step("f 1/1/1 2/2/1 3/3/1\nf 1/1/1 3/3/1 4/4/1\n"), 1e-5);
    EXPECT_LT(step("f 1/1/1 2/2/1 3/3/1 4/4/1\n"), 1e-5);
    EXPECT_GT(step("f 1/1/1 2/2/1 3/3/1\nf 1/1/2 3/3/2 4/4/2\n"), 0.1) << "an edge";
    EXPECT_GT(step("f 1/1 2/2 3/3\nf 1/1 3/3 4/4\n"), 0.1) << "no normals";
}

/// A number beyond the vertices of the file is not that of a vertex that was split.
TEST_F(ObjMaterial, BadCornersStayBad) {
    picture("four.png", {kRed, kGreen, kBlue, kWhite});
    folder_.write("a.mtl", "newmtl one\nmap_Kd four.png\nnewmtl two\n");
    for (const char* last : {"f 1/1 2/2 6/3\n", "usemtl two\nf 1 2 6\n", "f 1/1 2/2 5/3\n"}) {
        const TriangleMesh mesh = load(std::string(kSquareOfTexcoords) +
                                       "mtllib a.mtl\nusemtl one\n"
                                       "f 1/1 2/2 3/3\nf 1/4 3/1 4/2\n" +
                                       last);
        EXPECT_EQ(mesh.triangles.size(), 2u) << last;
        EXPECT_EQ(mesh.report.badVertexFaces, 1u) << last << describe(mesh.report);
    }
}

TEST_F(ObjMaterial, NumbersOutOfRangeAreCounted) {
    const auto clamped = [&](const std::string& lines) {
        return square(lines).report.remarks[kClampedMaterials];
    };
    EXPECT_EQ(clamped("Kd 1 0 0\nKs 1 1 1\nNs 1000\nPr 1\nKe 9 9 9\n"), 0u);
    for (const char* lines : {"Kd 255 0 0\n", "Kd -1 0 0\n", "Ks nan 0 0\n", "Pr 2\n", "d -1\n"})
        EXPECT_EQ(clamped(lines), 1u) << lines;
}

TEST_F(ObjMaterial, LightThatIsLessThanNoneOrEndlessIsRefused) {
    for (const char* light : {"-1 0 0", "nan 1 1", "inf 0 0", "0 1e16 0", "-3"})
        expectError([&] { square(std::string("Kd 1 0 0\nKe ") + light + "\n"); }, ".mtl: line 3",
                    "expected 0 to 1e+15");
    EXPECT_EQ(square("Ke 0 1e15 0\n").materials.at(0).finish.emission.y, 1e15f);
}

TEST_F(ObjMaterial, PicturesWithoutTexcoordsAreCounted) {
    picture("four.png", {kRed, kGreen, kBlue, kWhite});
    folder_.write("a.mtl", "newmtl one\nmap_Kd four.png\n");
    const TriangleMesh mesh = load(std::string(kSquareOfTexcoords) +
                                   "mtllib a.mtl\nusemtl one\nf 1/1 2/2 3/3\nf 1/1 3/3 4\n");
    const std::map<std::string, std::size_t> wanted{
        {"vertices without texture coordinates, whose material has a picture", 1}};
    EXPECT_EQ(mesh.report.remarks, wanted);
}

TEST_F(ObjMaterial, NamesMayBeInQuotes) {
    picture("four.png", {kRed, kRed, kRed, kRed});
    folder_.write("a.mtl", "newmtl one\nmap_Kd \"four.png\"\n");
    const TriangleMesh mesh = load(std::string(kSquareOfTexcoords) +
                                   "mtllib \"a.mtl\"\nusemtl one\nf 1/1 2/2 3/3\nf 1/1 3/3 4/4\n");
    expectColor(squareAt(mesh, 0.5f, 0.5f).baseColor, kRed);
    EXPECT_EQ(filesOf(folder_.path() / "a.obj", References::inside).size(), 3u);
}

TEST_F(ObjMaterial, FilesOutsideOnlyIfAllowed) {
    fs::create_directories(folder_.path() / "set");
    folder_.write("outside.mtl", "newmtl one\nKd 1 0 0\n");
    const fs::path set =
        folder_.write("set/a.obj", kSquareOfTexcoords +
                                       std::string("mtllib ../outside.mtl\nusemtl one\nf 1 2 3\n"));
    MeshOptions options;
    expectError([&] { loadMesh({&set, 1}, options); }, set.string(), "--allow-external");
    EXPECT_EQ(filesOf(set, References::inside).size(), 1u);
    options.references = References::anywhere;
    EXPECT_EQ(loadMesh({&set, 1}, options).materials.at(0).albedo, kRed);
    EXPECT_EQ(filesOf(set, References::anywhere).size(), 2u);
}

/// Windows' programs write backslashes, and pictures lie beside the library.
TEST_F(ObjMaterial, FilesOfFoldersAreFound) {
    fs::create_directories(folder_.path() / "sub/maps");
    picture("sub/maps/four.png", {kRed, kRed, kRed, kRed});
    folder_.write("sub/a.mtl", "newmtl one\nmap_Kd maps\\four.png\n");
    const TriangleMesh mesh = load(std::string(kSquareOfTexcoords) +
                                   "mtllib sub\\a.mtl\nusemtl one\nf 1/1 2/2 3/3\nf 1/1 3/3 4/4\n");
    expectColor(squareAt(mesh, 0.5f, 0.5f).baseColor, kRed);
    EXPECT_EQ(filesOf(folder_.path() / "a.obj", References::inside).size(), 3u);
}

}  // namespace
}  // namespace shadowcache::test
