#include <fmt/core.h>

#include <array>
#include <cctype>

#include "common/base/error.h"
#include "common/base/file_bytes.h"
#include "common/import/face_colors.h"
#include "common/import/mesh_reader.h"
#include "common/import/vertex_colors.h"

namespace shadowcache {

namespace {

/// What the prefix of the magic word ("STCNOFF") says of a vertex.
struct OffLayout {
    std::string prefix;
    bool color = false;
    bool normal = false;
    bool texcoord = false;
};

/// @param magic  the first word; what stands behind "OFF" is the first count ("OFF4 2 0")
OffLayout parseMagic(const std::filesystem::path& path, std::string_view magic) {
    const auto refuse = [&] {
        throwFileError(path, "first word is '" + std::string(magic.substr(0, 20)) +
                                 "', expected OFF, COFF, NOFF or STOFF");
    };
    const std::size_t place = magic.find("OFF");
    if (place == magic.npos) refuse();
    const std::string_view behind = magic.substr(place + 3);
    if (!behind.empty() && std::isdigit(static_cast<unsigned char>(behind.front())) == 0) refuse();
    std::string_view prefix = magic.substr(0, place);
    OffLayout layout;
    layout.prefix = prefix;
    if (prefix.starts_with("ST")) layout.texcoord = true, prefix.remove_prefix(2);
    if (prefix.starts_with("C")) layout.color = true, prefix.remove_prefix(1);
    if (prefix.starts_with("N")) layout.normal = true, prefix.remove_prefix(1);
    if (!prefix.empty()) refuse();
    return layout;
}

/// Reads the vertices and faces behind the counts. OFF is separated by white space, but the colour
/// of a face goes to the end of its line, and that of a vertex may lack its opacity there. So what
/// is left of a line is looked at; in a file whose lines mean nothing there must be no such gaps.
class OffBody {
public:
    OffBody(const std::filesystem::path& path, const TextScanner& text, const OffLayout& layout,
            bool byLines)
        : path_(path), text_(text), layout_(layout), byLines_(byLines) {}

    RawMesh read(long long vertices, long long faces) {
        mesh_.vertices.reserve(static_cast<std::size_t>(vertices));
        for (long long i = 0; i < vertices; ++i) {
            readVertex(start("vertices", i, vertices));
        }
        for (long long i = 0; i < faces; ++i) {
            readFace(start("faces", i, faces));
        }
        if (!text_.word().empty()) text_.fail("text after the last face, expected none");
        mesh_.badColors = decodeColors(scale_, mesh_.colors);
        finishFaceColors();
        return std::move(mesh_);
    }

private:
    /// First word of a vertex or face.
    std::string_view start(const char* what, long long index, long long count) {
        const std::string_view word = text_.word();
        if (word.empty())
            throwFileError(path_,
                           fmt::format("truncated: ends after {} of {} {}", index, count, what));
        return word;
    }

    double number() { return text_.number(text_.word()); }

    void readVertex(std::string_view first) {
        const double x = text_.number(first), y = number();
        mesh_.vertices.emplace_back(x, y, number());
        if (layout_.normal) {
            const double nx = number(), ny = number();
            mesh_.normals.emplace_back(nx, ny, number());
        }
        if (layout_.color) readColor();
        if (layout_.texcoord && !(byLines_ && text_.atLineEnd())) {
            number();
            number();
            ++mesh_.remarks["vertices whose texture coordinates are left out"];
        }
        if (byLines_ && !text_.atLineEnd())
            text_.fail("vertex with more numbers than " + layout_.prefix + "OFF has");
    }

    /// Red, green, blue and opacity, which a line may lack; it tells 0 to 1 from 0 to 255 as well.
    void readColor() {
        Rgb color;
        for (int k = 0; k < 3; ++k) {
            const double value = number();
            scale_.see(value);
            color[k] = static_cast<float>(value);
        }
        mesh_.colors.push_back(color);
        if (!byLines_ || !text_.atLineEnd()) scale_.see(number());
    }

    void readFace(std::string_view first) {
        const long long size = text_.integer(first);
        if (size < 0) text_.fail(fmt::format("face with {} corners, expected 3 or more", size));
        for (long long i = 0; i < size; ++i) {
            const long long index = text_.integer(text_.word());
            mesh_.faceVertices.push_back(
                index < 0 || index >= kNoVertex ? kNoVertex : static_cast<std::uint32_t>(index));
        }
        mesh_.faceSizes.push_back(static_cast<std::uint32_t>(size));
        if (byLines_) readFaceColor();
    }

    /// Behind the corners: nothing, the number of a colour in a map that is not in the file, or
    /// red, green, blue and perhaps opacity.
    void readFaceColor() {
        std::vector<std::string_view> words;
        for (std::string_view word = text_.wordOnLine(); !word.empty(); word = text_.wordOnLine())
            words.push_back(word);
        if (words.size() == 3 || words.size() == 4) {
            std::array<double, 4> color{};
            for (std::size_t k = 0; k < words.size(); ++k) {
                color[k] = text_.number(words[k]);
                faceScale_.see(color[k]);
            }
            faceColors_.push_back(Rgb(Vec3d(color[0], color[1], color[2])));
            coloredFaces_.push_back(mesh_.faceSizes.size() - 1);
        } else if (!words.empty()) {
            ++mesh_.remarks["faces whose colours are left out: no red, green and blue"];
        }
        text_.nextLine();
    }

    void finishFaceColors() {
        if (faceColors_.empty()) return;
        mesh_.badColors += decodeColors(faceScale_, faceColors_);
        std::vector<Rgb> all(mesh_.faceSizes.size(), kUncolored);
        for (std::size_t i = 0; i < faceColors_.size(); ++i) all[coloredFaces_[i]] = faceColors_[i];
        colorFaces(all, mesh_);
    }

    const std::filesystem::path& path_;
    TextScanner text_;
    const OffLayout& layout_;
    bool byLines_;
    ColorScale scale_{ColorNumbers::any}, faceScale_{ColorNumbers::any};
    std::vector<Rgb> faceColors_;            ///< of the faces that have one
    std::vector<std::size_t> coloredFaces_;  ///< which these are
    RawMesh mesh_;
};

/// The number of edges, which nobody needs, on the line of the counts or alone on the next.
void skipEdges(TextScanner& text) {
    if (!text.wordOnLine().empty()) return;
    TextScanner ahead = text;
    if (!ahead.word().empty() && ahead.atLineEnd()) text = ahead;
}

}  // namespace

RawMesh readOff(const std::filesystem::path& path) {
    std::string bytes = readFileBytes(path);
    useLineFeeds(bytes);
    TextScanner text(path, withoutByteOrderMark(path, bytes), true);
    const std::string_view magic = text.word();
    const OffLayout layout = parseMagic(path, magic);
    std::string_view next = magic.substr(magic.find("OFF") + 3);
    if (next.empty()) next = text.word();
    if (next == "BINARY") throwFileError(path, "is a binary OFF file, expected a text one");
    if (next.empty()) throwFileError(path, "truncated: ends before the counts");
    const long long vertices = text.integer(next);
    const long long faces = text.integer(text.word());
    // Shortest: "0 0 0 " and "0 ".
    if (vertices < 0 || faces < 0 ||
        static_cast<double>(vertices) * 6.0 + static_cast<double>(faces) * 2.0 >
            static_cast<double>(text.bytesLeft()) + 1.0) {
        throwFileError(path, fmt::format("truncated: {} bytes cannot hold {} vertices and {} faces",
                                         text.bytesLeft(), vertices, faces));
    }
    skipEdges(text);
    try {
        return OffBody(path, text, layout, true).read(vertices, faces);
    } catch (const Error&) {
        // Several vertices or faces on a line? Then every number must have its place.
        try {
            return OffBody(path, text, layout, false).read(vertices, faces);
        } catch (const Error&) {
        }
        throw;
    }
}

}  // namespace shadowcache
