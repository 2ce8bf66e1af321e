#include <algorithm>
#include <array>

#include "common/base/error.h"
#include "common/base/file_bytes.h"
#include "common/image/srgb.h"
#include "common/import/mesh_reader.h"

namespace shadowcache {

namespace {

/// What the prefix of the magic word ("STCNOFF") says of a vertex line.
struct OffLayout {
    bool color = false;
    bool normal = false;
};

OffLayout parseMagic(const std::filesystem::path& path, std::string_view magic) {
    const auto refuse = [&] {
        throwFileError(path, "first word is '" + std::string(magic.substr(0, 20)) +
                                 "', expected OFF, COFF, NOFF or STOFF");
    };
    if (!magic.ends_with("OFF")) refuse();
    std::string_view prefix = magic.substr(0, magic.size() - 3);
    OffLayout layout;
    if (prefix.starts_with("ST")) prefix.remove_prefix(2);
    if (prefix.starts_with("C")) layout.color = true, prefix.remove_prefix(1);
    if (prefix.starts_with("N")) layout.normal = true, prefix.remove_prefix(1);
    if (!prefix.empty()) refuse();
    return layout;
}

/// Colour at the start of `words`: whole numbers are 8-bit sRGB, others linear.
Rgb parseColor(const TextScanner& text, const std::array<std::string_view, 3>& words) {
    const bool whole = std::all_of(words.begin(), words.end(), [](std::string_view word) {
        return word.find_first_of(".eE") == word.npos;
    });
    std::array<float, 3> rgb{};
    for (std::size_t i = 0; i < 3; ++i) {
        const auto value = static_cast<float>(text.number(words[i]));
        rgb[i] = whole ? srgbToLinear(std::clamp(value / 255.0f, 0.0f, 1.0f)) : value;
    }
    return {rgb[0], rgb[1], rgb[2]};
}

void readVertex(TextScanner& text, const OffLayout& layout, std::string_view firstWord,
                RawMesh& mesh) {
    const double x = text.number(firstWord);
    const double y = text.number(text.wordOnLine());
    const double z = text.number(text.wordOnLine());
    mesh.vertices.emplace_back(x, y, z);
    if (layout.normal) {
        const double nx = text.number(text.wordOnLine());
        const double ny = text.number(text.wordOnLine());
        mesh.normals.emplace_back(nx, ny, text.number(text.wordOnLine()));
    }
    if (!layout.color) return;
    const std::array<std::string_view, 3> words{text.wordOnLine(), text.wordOnLine(),
                                                text.wordOnLine()};
    mesh.colors.push_back(parseColor(text, words));
}

void readFace(TextScanner& text, std::string_view firstWord, RawMesh& mesh) {
    const long long size = text.integer(firstWord);
    if (size < 0) text.fail("face with " + std::to_string(size) + " corners, expected 3 or more");
    for (long long i = 0; i < size; ++i) {
        const long long index = text.integer(text.wordOnLine());
        mesh.faceVertices.push_back(
            index < 0 || index >= kNoVertex ? kNoVertex : static_cast<std::uint32_t>(index));
    }
    mesh.faceSizes.push_back(static_cast<std::uint32_t>(size));
}

/// First word of the next line that is not blank.
std::string_view startLine(const std::filesystem::path& path, TextScanner& text, const char* what,
                           long long index, long long count) {
    text.nextLine();
    const std::string_view word = text.word();
    if (word.empty()) {
        throwFileError(path, std::string("truncated: ends after ") + std::to_string(index) +
                                 " of " + std::to_string(count) + " " + what);
    }
    return word;
}

}  // namespace

RawMesh readOff(const std::filesystem::path& path) {
    const std::string bytes = readFileBytes(path);
    TextScanner text(path, bytes, true);
    const OffLayout layout = parseMagic(path, text.word());

    const std::string_view next = text.word();
    if (next == "BINARY") throwFileError(path, "is a binary OFF file, expected a text one");
    if (next.empty()) throwFileError(path, "truncated: ends before the counts");
    const long long vertices = text.integer(next);
    const long long faces = text.integer(text.wordOnLine());
    // Shortest lines: "0 0 0" and "0" with a line break each.
    if (vertices < 0 || faces < 0 ||
        static_cast<double>(vertices) * 6.0 + static_cast<double>(faces) * 2.0 >
            static_cast<double>(text.bytesLeft()) + 1.0) {
        throwFileError(path, "truncated: " + std::to_string(text.bytesLeft()) +
                                 " bytes cannot hold " + std::to_string(vertices) +
                                 " vertices and " + std::to_string(faces) + " faces");
    }

    RawMesh mesh;
    mesh.vertices.reserve(static_cast<std::size_t>(vertices));
    for (long long i = 0; i < vertices; ++i) {
        readVertex(text, layout, startLine(path, text, "vertices", i, vertices), mesh);
    }
    for (long long i = 0; i < faces; ++i) {
        readFace(text, startLine(path, text, "faces", i, faces), mesh);
    }
    return mesh;
}

}  // namespace shadowcache
