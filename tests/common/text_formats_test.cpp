// OBJ, PLY, OFF and STL of other writers; what is left out is counted; numbers that do not fit
// their header are refused with the line.

#include <gtest/gtest.h>

#include "common/import/load_mesh.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/loaded_mesh.h"
#include "tests/support/mesh_files.h"
#include "tests/support/temporary_folder.h"

namespace shadowcache::test {
namespace {

void expectRefused(const std::string& name, const std::string& bytes, const std::string& cause) {
    expectError([&] { loadBytes(name, bytes); }, name, cause);
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    for (std::size_t at = text.find(from); at != text.npos; at = text.find(from, at + to.size()))
        text.replace(at, from.size(), to);
    return text;
}

/// Two triangles, with nothing dropped, or said but `remark`.
void expectTwo(const TriangleMesh& mesh, const std::string& remark = "") {
    const std::string said = remark.empty() ? "" : "; " + remark;
    const std::string text = describe(mesh.report);
    EXPECT_TRUE(text == "2 triangles" + said ||
                text == "2 triangles; 1 n-gons cut into 2 triangles" + said)
        << text;
}

const std::string kNoEnd = "1 STL solids without 'endsolid', perhaps cut short";

TEST(TextCases, HaveTheirTriangles) {
    const std::filesystem::path cases = SHADOWCACHE_CASES;
    for (const char* name :
         {"byte_order_mark.obj", "counts_behind_keyword.off", "face_over_lines.off",
          "upper_case.stl", "blank_before_solid.stl", "end_solid_of_two_words.stl"})
        expectTwo(loadFile(cases / name));
    expectTwo(loadFile(cases / "no_end.stl"), kNoEnd);
    expectError([&] { loadFile(cases / "rows_longer_than_header.ply"); },
                "rows_longer_than_header.ply",
                "line 17: row of 'face' with more numbers than its 4 properties in the header");
}

TEST(TextFiles, MayBeginWithAByteOrderMark) {
    const std::string mark = "\xef\xbb\xbf";
    expectTwo(loadBytes("a.obj", mark + squareObj()));
    expectTwo(loadBytes("a.off", mark + squareOff()));
    expectTwo(loadBytes("a.ply", mark + squarePlyText()));
    expectTwo(loadBytes("b.ply", mark + squarePly()));
    expectTwo(loadBytes("a.stl", mark + squareStlText()));
    const TemporaryFolder folder;
    GltfBuilder square = squareGltf();
    square.root({{"mesh", 0}});
    folder.write("a.bin", square.data());
    expectTwo(loadFile(folder.write("a.gltf", mark + square.gltf("a.bin"))));
    for (const std::string name : {"a.obj", "a.off", "a.ply", "a.stl"})
        for (const std::string utf16 : {"\xff\xfe", "\xfe\xff"})
            expectRefused(name, utf16 + std::string("v\0 \0", 4), "is text in UTF-16");
}

TEST(Off, IsSeparatedByWhiteSpace) {
    const std::string numbers = squareOff().substr(4);
    expectTwo(loadBytes("a.off", "OFF" + numbers));
    expectTwo(loadBytes("a.off", "OFF " + replaced(numbers, "\n", " ")));
    expectTwo(loadBytes("a.off", replaced("OFF " + numbers, " ", "\n")));
    expectTwo(loadBytes("a.off", replaced("OFF\n" + numbers, "\n", "\r\n")));
    // Without the number of edges.
    expectTwo(loadBytes("a.off", replaced(squareOff(), "4 2 0", "4 2")));
    // Faces with colours, a comment, and a vertex over two lines.
    expectTwo(loadBytes("a.off",
                        "OFF\n4 2 0 # edges\n0 0\n0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2 1 0 0\n"
                        "3 0 2\n3 0.5 0.5 0.5 1 # grey\n\n"));
    expectTwo(loadBytes("a.off",
                        "STCNOFF4 2 0\n0 0 0 0 0 1 1 0 0 1 0.5 0.5\n1 0 0 0 0 1 1 0 0 1 0 0\n"
                        "1 1 0 0 0 1 1 0 0 1 0 0\n0 1 0 0 0 1 1 0 0 1 0 0\n3 0 1 2\n3 0 2 3\n"),
              "4 vertices whose texture coordinates are left out");
}

TEST(Off, WhoseNumbersDoNotFitIsRefused) {
    expectRefused("a.off", squareOff() + "3 0 1 2\n", "line 9: text after the last face");
    expectRefused("a.off", replaced(squareOff(), "1 0 0\n", "1 0 0 255 0 0\n"),
                  "line 4: vertex with more numbers than OFF has");
    expectRefused("a.off", replaced(squareOff(), "3 0 2 3\n", ""), "truncated: ends after 1 of 2");
    expectRefused("a.off", "OFFx 4 2 0\n", "first word is 'OFFx', expected OFF");
    expectRefused("a.off", "OFF BINARY\n", "is a binary OFF file");
}

TEST(Ply, WhoseRowsDoNotFitIsRefused) {
    const std::string good = squarePlyText();
    expectRefused("a.ply", replaced(good, "1 0 0\n", "1 0 0 9\n"),
                  "line 11: row of 'vertex' with more numbers than its 3 properties");
    expectRefused("a.ply", replaced(good, "3 0 1 2\n", "3 0 1 2 9\n"),
                  "line 14: row of 'face' with more numbers than its 1 properties");
    expectRefused("a.ply", good + "3 0 1 2\n", "line 16: text after the last row");
    expectRefused("a.ply", replaced(good, "face 2", "face 1"), "line 15: text after the last row");
    // The true cause is the short row, wherever it shows.
    expectRefused("a.ply", replaced(good, "1 0 0\n", "1 0\n"),
                  "(line 11 has fewer numbers than the header says)");
    expectRefused("a.ply", replaced(good, "3 0 2 3", "3 0 2"),
                  "truncated: text ends within the data");
    // Rows over several lines, blank lines and blanks at the end.
    expectTwo(loadBytes("a.ply", replaced(good, "1 0 0\n", "1\n0 0 \t\r\n\n") + "\n \n"));
}

TEST(Ply, WithBytesLeftOverIsRefused) {
    expectTwo(loadBytes("a.ply", squarePly() + "\n"));
    expectTwo(loadBytes("a.ply", squarePly() + std::string(3, '\0')));
    expectRefused("a.ply", squarePly() + "\3",
                  "1 bytes after the last row that the header counts, expected none");
}

TEST(Stl, TextIsReadInAllItsForms) {
    const std::string good = squareStlText();
    std::string upper = good;
    for (char& c : upper) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    expectTwo(loadBytes("a.stl", upper));
    expectTwo(loadBytes("a.stl", "\n \t" + good));
    expectTwo(loadBytes("a.stl", replaced(good, "\n", "\r\n")));
    expectTwo(loadBytes("a.stl", replaced(good, "endsolid", "end solid my vertex")));
    expectTwo(loadBytes("a.stl",
                        replaced(replaced(good, "endloop", "end loop"), "endfacet", "End Facet")));
    expectTwo(loadBytes("a.stl", replaced(good, "facet normal 0 0 1\n", "facet\n")));
    expectTwo(
        loadBytes("a.stl", replaced(good, "facet normal 0 0 1\n", "facet normal -nan(ind) 0 1 ")));
    expectTwo(loadBytes("a.stl", replaced(good, "vertex 1 0 0", "vertex\n1 0\n0")));
    // Several solids, one of which does not end.
    const std::string first = good.substr(0, good.find("facet", good.find("endfacet") + 8));
    const std::string second = "solid\n" + good.substr(first.size());
    expectTwo(loadBytes("a.stl", first + "endsolid\n" + second));
    expectTwo(loadBytes("a.stl", first + second), kNoEnd);
}

TEST(Stl, TextThatIsCutIsRefusedOrSaid) {
    const std::string good = squareStlText();
    for (std::size_t length = 1; length + 1 < good.size(); ++length) {
        try {
            const TriangleMesh mesh = loadBytes("a.stl", good.substr(0, length));
            EXPECT_NE(describe(mesh.report).find(kNoEnd), std::string::npos) << length;
        } catch (const Error&) {
        }
    }
    expectRefused("a.stl", replaced(good, "endloop\nendfacet\nendsolid\n", ""),
                  "truncated: ends within triangle 2");
    expectRefused("a.stl", replaced(good, "vertex 1 0 0", "vortex 1 0 0"),
                  "line 5: 'vortex', expected 'vertex' or 'endloop'");
}

TEST(Stl, BinaryIsToldBySizeAndContent) {
    std::string solid = squareStl();
    solid.replace(0, 6, "solid ");
    expectTwo(loadBytes("a.stl", solid));
    // Bytes after the last triangle are said, whatever the header begins with.
    for (const std::string& good : {solid, squareStl()})
        expectTwo(loadBytes("a.stl", good + std::string(7, 'x')),
                  "7 bytes after the last triangle of a binary STL file, left out");
    // As many as triangles would take: then the number is wrong.
    std::string fewer = solid;
    fewer[80] = 1;
    expectRefused("a.stl", fewer,
                  "binary STL with a wrong number of triangles: 1 triangles, which take 134 bytes, "
                  "in a file of 184");
    fewer[80] = 0;
    expectRefused("a.stl", fewer, "binary STL with a wrong number of triangles: 0 triangles");
    expectRefused("a.stl", solid.substr(0, 150), "truncated, or neither STL text");
    expectRefused("a.stl", "solids\nfacet", "12 bytes without 'solid' at the start");
}

/// As old Macs have them.
TEST(TextFiles, MayEndTheirLinesInCrAlone) {
    const auto mac = [](const std::string& text) { return replaced(text, "\n", "\r"); };
    expectTwo(loadBytes("a.obj", mac(squareObj())));
    expectTwo(loadBytes("a.off", mac("OFF # a comment\n" + squareOff().substr(4))));
    expectTwo(loadBytes("a.ply", mac(squarePlyText())));
    expectTwo(loadBytes("a.stl", mac(squareStlText())));
    const std::string binary = squarePly(), end = "end_header\n";
    const std::size_t body = binary.find(end) + end.size();
    expectTwo(loadBytes("a.ply", mac(binary.substr(0, body)) + binary.substr(body)));
}

TEST(TextFiles, MayHoldWhatWindowsWritesForNoNumber) {
    for (const char* word : {"1.#INF", "-1.#IND", "1.#QNAN0"})
        EXPECT_EQ(loadBytes("a.obj", "v " + std::string(word) + " 0 0\n" +
                                         replaced(squareObj(), "f 1", "f 2 3 4\nf 1"))
                      .report.badVertexFaces,
                  2u)
            << word;
    expectRefused("a.obj", replaced(squareObj(), "v 1 0 0", "v 1.#FOO 0 0"), "expected a number");
}

TEST(Obj, NormalsThatAreMissingAreCounted) {
    const std::string vertices = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
    expectTwo(loadBytes("a.obj", vertices + "f 1//1 2//1 3//1\nf 1 3 4\n"),
              "3 corners whose normals the file does not have");
    expectTwo(loadBytes("a.obj", vertices + "vn 0 0 1\nf 1//1 2//1 3//1\nf 1 3 4\n"));
}

TEST(Obj, WhatIsLostIsCounted) {
    expectTwo(loadBytes("a.obj", squareObj() + "l 1 2\np 3\n"), "2 points and lines left out");
    expectTwo(loadBytes("a.obj", squareObj() + "surf 0 1 0 1 1 2 3 4\nend\n"),
              "1 free-form surfaces left out");
    expectTwo(loadBytes("a.obj", squareObj() + "call other.obj\nF 1 2 3\n"),
              "2 lines of other statements left out (call, usemap, ...)");
    expectTwo(loadBytes("a.obj", "o a\ng b c\ns 1\ncstype bezier\n" + squareObj() + "vp 0 1\n"));
    // The older name of a face.
    expectTwo(loadBytes("a.obj", replaced(squareObj(), "f 1 3 4", "fo 1 3 4")));
}

TEST(Ply, WhatIsLostIsCounted) {
    const std::string good = squarePlyText();
    expectTwo(loadBytes("a.ply", replaced(good, "element vertex",
                                          "comment TextureFile a.png\nelement vertex")),
              "1 pictures of TextureFile comments left out");
    // Corners may be of a float type; one that is no whole number is no corner.
    const std::string floats = replaced(good, "uchar int", "uchar float");
    expectTwo(loadBytes("a.ply", floats));
    EXPECT_EQ(loadBytes("a.ply", replaced(floats, "3 0 2 3", "3 0 2 2.5")).report.badVertexFaces,
              1u);
}

TEST(Stl, ColoursOfBinaryFilesAreCounted) {
    constexpr std::size_t kFirstMark = 84 + 49;
    std::string visCam = squareStl();
    visCam[kFirstMark] = '\x80';
    const std::string remark = " triangles of a binary STL file whose colours are left out";
    expectTwo(loadBytes("a.stl", visCam), "1" + remark);
    std::string magics = squareStl();
    magics.replace(0, 10, "COLOR=\xff\xff\xff\xff");
    expectTwo(loadBytes("a.stl", magics), "2" + remark);
}

}  // namespace
}  // namespace shadowcache::test
