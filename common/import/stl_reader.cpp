#include <cstring>

#include "common/base/error.h"
#include "common/base/file_bytes.h"
#include "common/import/mesh_reader.h"
#include "common/mesh/point_table.h"

namespace shadowcache {

namespace {

constexpr std::size_t kHeaderBytes = 84;  // 80 free ones and the number of triangles
constexpr std::size_t kTriangleBytes = 50;

std::uint32_t binaryCount(const std::string& bytes) {
    std::uint32_t count = 0;
    std::memcpy(&count, bytes.data() + 80, sizeof count);
    return count;
}

void useWeldedPoints(const PointTable& table, RawMesh& mesh) {
    mesh.vertices.assign(table.points().begin(), table.points().end());
}

/// Corners are welded by their exact bits: STL repeats each vertex in every face around it.
RawMesh readBinary(const std::string& bytes) {
    const std::uint32_t count = binaryCount(bytes);
    RawMesh mesh;
    mesh.faceVertices.reserve(std::size_t{count} * 3);
    PointTable table(count / 2);
    for (std::size_t i = 0; i < count; ++i) {
        const char* corners = bytes.data() + kHeaderBytes + i * kTriangleBytes + 12;
        for (std::size_t corner = 0; corner < 3; ++corner) {
            Vec3f point;
            std::memcpy(static_cast<void*>(&point), corners + corner * 12, sizeof point);
            mesh.faceVertices.push_back(table.add(point));
        }
    }
    mesh.faceSizes.assign(count, 3);
    useWeldedPoints(table, mesh);
    return mesh;
}

RawMesh readText(const std::filesystem::path& path, const std::string& bytes) {
    RawMesh mesh;
    PointTable table(bytes.size() / 500);
    TextScanner text(path, bytes, false);
    std::uint32_t corners = 0;
    bool inSolid = false;
    for (std::string_view word = text.word(); !word.empty(); word = text.word()) {
        if (word == "solid" || word == "endsolid") {
            inSolid = word == "solid";
            text.nextLine();  // the solid's name may be any text
        } else if (word == "facet") {
            text.nextLine();  // the normal is not used: winding and normals of real sets disagree
        } else if (word == "vertex") {
            const auto x = static_cast<float>(text.number(text.wordOnLine()));
            const auto y = static_cast<float>(text.number(text.wordOnLine()));
            const auto z = static_cast<float>(text.number(text.wordOnLine()));
            mesh.faceVertices.push_back(table.add({x, y, z}));
            ++corners;
        } else if (word == "endloop") {
            mesh.faceSizes.push_back(corners);
            corners = 0;
        } else if (word != "outer" && word != "loop" && word != "endfacet") {
            text.fail("'" + std::string(word.substr(0, 20)) + "', expected an STL keyword");
        }
    }
    if (inSolid || corners > 0) {
        throwFileError(path, "truncated: ends after " + std::to_string(mesh.faceSizes.size()) +
                                 " triangles without 'endsolid'");
    }
    useWeldedPoints(table, mesh);
    return mesh;
}

}  // namespace

RawMesh readStl(const std::filesystem::path& path) {
    const std::string bytes = readFileBytes(path);
    // Many binary files start with "solid" all the same, so the size decides first.
    if (bytes.size() >= kHeaderBytes &&
        bytes.size() == kHeaderBytes + kTriangleBytes * binaryCount(bytes)) {
        return readBinary(bytes);
    }
    if (bytes.starts_with("solid") && bytes.substr(0, 1000).find('\0') == bytes.npos) {
        return readText(path, bytes);
    }
    if (bytes.size() < kHeaderBytes) {
        throwFileError(path, std::to_string(bytes.size()) +
                                 " bytes without 'solid' at the start, expected an STL file");
    }
    const std::uint32_t count = binaryCount(bytes);
    throwFileError(path, "truncated or no STL file: " + std::to_string(bytes.size()) +
                             " bytes, expected " +
                             std::to_string(kHeaderBytes + kTriangleBytes * count) + " for " +
                             std::to_string(count) + " triangles");
}

}  // namespace shadowcache
