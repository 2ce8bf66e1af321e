#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <map>

#include "common/base/error.h"
#include "common/base/file_bytes.h"
#include "common/import/mesh_reader.h"
#include "common/import/obj_looks.h"
#include "common/import/vertex_colors.h"

namespace shadowcache {

namespace {

/// The colours of a file, as it has them.
struct ObjColors {
    std::vector<bool> given;  ///< by vertex; empty: none has a colour
    ColorScale scale{ColorNumbers::any};
};

/// Position, and a colour behind it as many tools write it ("v x y z r g b"); four numbers are
/// x y z w.
void readVertex(TextScanner& text, ObjColors& colors, RawMesh& mesh) {
    std::array<double, 6> values{};
    std::size_t count = 0;
    for (std::string_view word = text.wordOnLine(); !word.empty(); word = text.wordOnLine()) {
        if (count < values.size()) values[count] = text.number(word);
        ++count;
    }
    if (count < 3) {
        text.fail(fmt::format("vertex with {} numbers, expected 3 (truncated?)", count));
    }
    mesh.vertices.emplace_back(values[0], values[1], values[2]);
    if (count >= 6) {
        mesh.colors.resize(mesh.vertices.size() - 1, kUncolored);
        mesh.colors.emplace_back(static_cast<float>(values[3]), static_cast<float>(values[4]),
                                 static_cast<float>(values[5]));
        colors.given.resize(mesh.vertices.size(), false);
        colors.given.back() = true;
        for (std::size_t k = 3; k < 6; ++k) colors.scale.see(values[k]);
    }
}

void finishColors(ObjColors& colors, RawMesh& mesh) {
    if (mesh.colors.empty()) return;
    mesh.badColors = decodeColors(colors.scale, mesh.colors);
    mesh.colors.resize(mesh.vertices.size(), kUncolored);
    colors.given.resize(mesh.vertices.size(), false);
    for (std::size_t i = 0; i < mesh.colors.size(); ++i)
        if (!colors.given[i]) mesh.colors[i] = kUncolored;
}

void readNormal(TextScanner& text, RawMesh& mesh) {
    const double x = text.number(text.wordOnLine());
    const double y = text.number(text.wordOnLine());
    mesh.normals.emplace_back(x, y, text.number(text.wordOnLine()));
}

/// Numbers start at 1; negative ones count back from the last of the `known` so far.
std::uint32_t indexOf(const TextScanner& text, std::string_view word, std::size_t known) {
    const long long number = text.integer(word);
    const long long index = number < 0 ? static_cast<long long>(known) + number : number - 1;
    return index < 0 || index >= kNoVertex ? kNoVertex : static_cast<std::uint32_t>(index);
}

/// v grows upwards; a third number is of pictures with three dimensions.
void readTexcoord(TextScanner& text, ObjLooks& looks) {
    const double u = text.number(text.wordOnLine());
    const std::string_view second = text.wordOnLine();
    const double v = second.empty() ? 0 : text.number(second);
    looks.texcoords.emplace_back(u, v);
}

/// A corner is v, v/vt, v//vn or v/vt/vn.
void readCorner(const TextScanner& text, std::string_view word, RawMesh& mesh, ObjLooks& looks) {
    const std::size_t first = word.find('/');
    mesh.faceVertices.push_back(indexOf(text, word.substr(0, first), mesh.vertices.size()));
    const std::size_t second = first == word.npos ? word.npos : word.find('/', first + 1);
    const std::string_view texcoord =
        first == word.npos ? "" : word.substr(first + 1, second - first - 1);
    looks.faceTexcoords.push_back(
        texcoord.empty() ? kNoVertex : indexOf(text, texcoord, looks.texcoords.size()));
    const std::string_view normal = second == word.npos ? "" : word.substr(second + 1);
    mesh.faceNormals.push_back(normal.empty() ? kNoVertex
                                              : indexOf(text, normal, mesh.normals.size()));
}

/// Of a file without normals.
void dropNormals(RawMesh& mesh) {
    const auto named = mesh.faceNormals.size() -
                       static_cast<std::size_t>(std::ranges::count(mesh.faceNormals, kNoVertex));
    if (named > 0) mesh.remarks["corners whose normals the file does not have"] = named;
    mesh.faceNormals.clear();
}

std::uint32_t readFace(TextScanner& text, RawMesh& mesh, ObjLooks& looks) {
    std::uint32_t size = 0;
    for (std::string_view word = text.wordOnLine(); !word.empty(); word = text.wordOnLine()) {
        readCorner(text, word, mesh, looks);
        ++size;
    }
    mesh.faceSizes.push_back(size);
    if (looks.runs.empty()) looks.runs.emplace_back();
    ++looks.runs.back().faceCount;
    return size;
}

/// Faces from here on are of the material that the line names.
void startMaterial(const TextScanner& text, std::map<std::string, int, std::less<>>& numbers,
                   ObjLooks& looks) {
    const std::string_view name = text.restOfLine();
    auto place = numbers.find(name);
    if (place == numbers.end()) {
        place = numbers.emplace(name, static_cast<int>(looks.names.size())).first;
        looks.names.emplace_back(name);
    }
    if (looks.runs.empty() || looks.runs.back().faceCount > 0) looks.runs.emplace_back();
    looks.runs.back().material = place->second;
}

/// Statements that change nothing of what is read, or belong to one that is counted.
constexpr std::array<std::string_view, 30> kWithoutEffect{
    "#",      "bevel", "bmat",      "bsp",      "bzp", "c_interp", "cdc",        "con",
    "cstype", "ctech", "curv2",     "d_interp", "deg", "end",      "g",          "hole",
    "lod",    "mg",    "o",         "parm",     "s",   "scrv",     "shadow_obj", "sp",
    "stech",  "step",  "trace_obj", "trim",     "vp",  "res"};

/// A statement that adds nothing to the faces is counted where something of the picture is lost.
void countStatement(std::string_view keyword, RawMesh& mesh) {
    if (keyword.empty() || std::ranges::find(kWithoutEffect, keyword) != kWithoutEffect.end())
        return;
    if (keyword == "p" || keyword == "l" || keyword == "curv") {
        ++mesh.remarks["points and lines left out"];
    } else if (keyword == "surf") {
        ++mesh.remarks["free-form surfaces left out"];
    } else {
        ++mesh.remarks["lines of other statements left out (call, usemap, ...)"];
    }
}

}  // namespace

RawMesh readObj(const std::filesystem::path& path, References references) {
    std::string bytes = readFileBytes(path);
    useLineFeeds(bytes);
    TextScanner text(path, withoutByteOrderMark(path, bytes), true);
    if (bytes.find('\0') != bytes.npos)
        throwFileError(path, "holds binary data, expected OBJ text");

    RawMesh mesh;
    ObjColors colors;
    ObjLooks looks;
    std::map<std::string, int, std::less<>> materials;
    while (!text.atEnd()) {
        const std::string_view keyword = text.wordOnLine();
        if (keyword == "v") {
            readVertex(text, colors, mesh);
            looks.colored.push_back(colors.given.size() == mesh.vertices.size());
        } else if (keyword == "vn") {
            readNormal(text, mesh);
        } else if (keyword == "vt") {
            readTexcoord(text, looks);
        } else if (keyword == "mtllib") {
            looks.libraries.emplace_back(text.restOfLine());
        } else if (keyword == "usemtl") {
            startMaterial(text, materials, looks);
        } else if (keyword == "f" || keyword == "fo") {  // an older name
            const std::uint32_t size = readFace(text, mesh, looks);
            if (size < 3 && text.atEnd()) {
                text.fail(fmt::format(
                    "file ends in a face with {} corners, expected 3 (truncated?)", size));
            }
        } else {
            countStatement(keyword, mesh);
        }
        text.nextLine();
    }
    if (mesh.vertices.empty()) throwFileError(path, "has no vertex line, expected OBJ text");
    if (mesh.faceSizes.empty())
        throwFileError(path, "has no face, expected at least one (truncated?)");
    finishColors(colors, mesh);
    if (mesh.normals.empty()) dropNormals(mesh);
    addObjLooks(path, references, looks, mesh);
    return mesh;
}

}  // namespace shadowcache
