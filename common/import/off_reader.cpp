#include <cctype>

#include "common/base/error.h"
#include "common/base/file_bytes.h"
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
        return std::move(mesh_);
    }

private:
    /// First word of a vertex or face.
    std::string_view start(const char* what, long long index, long long count) {
        const std::string_view word = text_.word();
        if (word.empty())
            throwFileError(path_, std::string("truncated: ends after ") + std::to_string(index) +
                                      " of " + std::to_string(count) + " " + what);
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
        if (size < 0)
            text_.fail("face with " + std::to_string(size) + " corners, expected 3 or more");
        for (long long i = 0; i < size; ++i) {
            const long long index = text_.integer(text_.word());
            mesh_.faceVertices.push_back(
                index < 0 || index >= kNoVertex ? kNoVertex : static_cast<std::uint32_t>(index));
        }
        mesh_.faceSizes.push_back(static_cast<std::uint32_t>(size));
        if (byLines_) text_.nextLine();
    }

    const std::filesystem::path& path_;
    TextScanner text_;
    const OffLayout& layout_;
    bool byLines_;
    ColorScale scale_{ColorNumbers::any};
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
    const std::string bytes = readFileBytes(path);
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
        throwFileError(path, "truncated: " + std::to_string(text.bytesLeft()) +
                                 " bytes cannot hold " + std::to_string(vertices) +
                                 " vertices and " + std::to_string(faces) + " faces");
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
