#include <array>

#include "common/base/error.h"
#include "common/base/file_bytes.h"
#include "common/import/mesh_reader.h"

namespace shadowcache {

namespace {

/// Position, and a colour behind it as many tools write it ("v x y z r g b", linear as it stands);
/// four numbers are x y z w.
void readVertex(TextScanner& text, RawMesh& mesh) {
    std::array<double, 6> values{};
    std::size_t count = 0;
    for (std::string_view word = text.wordOnLine(); !word.empty(); word = text.wordOnLine()) {
        if (count < values.size()) values[count] = text.number(word);
        ++count;
    }
    if (count < 3) {
        text.fail("vertex with " + std::to_string(count) + " numbers, expected 3 (truncated?)");
    }
    mesh.vertices.emplace_back(values[0], values[1], values[2]);
    if (count >= 6) {
        mesh.colors.resize(mesh.vertices.size() - 1, kUncolored);
        mesh.colors.emplace_back(static_cast<float>(values[3]), static_cast<float>(values[4]),
                                 static_cast<float>(values[5]));
    }
}

/// A corner is v, v/vt, v//vn or v/vt/vn; negative numbers count back from the last vertex so far.
std::uint32_t cornerVertex(const TextScanner& text, std::string_view word, std::size_t vertices) {
    const long long number = text.integer(word.substr(0, word.find('/')));
    const long long index = number < 0 ? static_cast<long long>(vertices) + number : number - 1;
    return index < 0 || index >= kNoVertex ? kNoVertex : static_cast<std::uint32_t>(index);
}

std::uint32_t readFace(TextScanner& text, RawMesh& mesh) {
    std::uint32_t size = 0;
    for (std::string_view word = text.wordOnLine(); !word.empty(); word = text.wordOnLine()) {
        mesh.faceVertices.push_back(cornerVertex(text, word, mesh.vertices.size()));
        ++size;
    }
    mesh.faceSizes.push_back(size);
    return size;
}

}  // namespace

RawMesh readObj(const std::filesystem::path& path) {
    const std::string bytes = readFileBytes(path);
    if (bytes.find('\0') != bytes.npos)
        throwFileError(path, "holds binary data, expected OBJ text");

    RawMesh mesh;
    TextScanner text(path, bytes, true);
    while (!text.atEnd()) {
        const std::string_view keyword = text.wordOnLine();
        if (keyword == "v") {
            readVertex(text, mesh);
        } else if (keyword == "f") {
            const std::uint32_t size = readFace(text, mesh);
            if (size < 3 && text.atEnd()) {
                text.fail("file ends in a face with " + std::to_string(size) +
                          " corners, expected 3 (truncated?)");
            }
        }
        text.nextLine();
    }
    if (mesh.vertices.empty()) throwFileError(path, "has no vertex line, expected OBJ text");
    if (mesh.faceSizes.empty())
        throwFileError(path, "has no face, expected at least one (truncated?)");
    if (!mesh.colors.empty()) mesh.colors.resize(mesh.vertices.size(), kUncolored);
    return mesh;
}

}  // namespace shadowcache
