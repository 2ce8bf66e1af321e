#include <fmt/core.h>

#include <array>
#include <cctype>
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

std::string lower(std::string_view word) {
    std::string result(word);
    for (char& c : result) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return result;
}

void useWeldedPoints(const PointTable& table, RawMesh& mesh) {
    mesh.vertices.assign(table.points().begin(), table.points().end());
}

/// Triangles that two programs give colours: all of a file whose header has COLOR= (Magics), and
/// else those with the highest bit of their last two bytes (VisCAM).
std::size_t coloredTriangles(const std::string& bytes, std::uint32_t count) {
    if (bytes.find("COLOR=") < 80) return count;
    std::size_t colored = 0;
    for (std::size_t i = 1; i <= count; ++i)
        colored += static_cast<unsigned char>(bytes[kHeaderBytes + i * kTriangleBytes - 1]) >> 7;
    return colored;
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
    if (const std::size_t colored = coloredTriangles(bytes, count); colored > 0)
        mesh.remarks["triangles of a binary STL file whose colours are left out"] = colored;
    return mesh;
}

/// Reads the keywords of an STL text, which may be in letters of any case; where lines break does
/// not matter but for the names behind 'solid' and 'endsolid'.
class StlText {
public:
    StlText(const std::filesystem::path& path, std::string_view text)
        : path_(path), text_(path, text, false), table_(text.size() / 500) {}

    RawMesh read() {
        for (std::string word = keyword(); !word.empty(); word = keyword()) take(word);
        if (corners_ > 0 || inFacet_)
            throwFileError(path_, fmt::format("truncated: ends within triangle {}",
                                              mesh_.faceSizes.size() + 1));
        endSolid();
        useWeldedPoints(table_, mesh_);
        return std::move(mesh_);
    }

private:
    /// The next word, in small letters; "end solid" is "endsolid". Empty at the end.
    std::string keyword() {
        std::string word = lower(text_.word());
        return word == "end" ? word + lower(text_.wordOnLine()) : word;
    }

    void take(const std::string& word) {
        if (corners_ > 0 && word != "vertex" && word != "endloop")
            refuse(word, "'vertex' or 'endloop'");
        if (word == "solid") {
            endSolid();
            inSolid_ = true;
            text_.nextLine();  // the solid's name may be any text
        } else if (word == "facet") {
            skipNormal();
            inFacet_ = true;
        } else if (word == "vertex") {
            readVertex();
        } else if (word == "endloop") {
            mesh_.faceSizes.push_back(corners_);
            corners_ = 0;
        } else if (word == "endfacet") {
            inFacet_ = false;
        } else if (word == "endsolid") {
            inSolid_ = false;
            text_.nextLine();
        } else if (word != "outer" && word != "loop") {
            refuse(word, "an STL keyword");
        }
    }

    [[noreturn]] void refuse(const std::string& word, const std::string& expected) const {
        text_.fail(fmt::format("'{}', expected {}", word.substr(0, 20), expected));
    }

    /// A solid that is still open has lost its end, and perhaps more.
    void endSolid() {
        if (inSolid_) ++mesh_.remarks["STL solids without 'endsolid', perhaps cut short"];
    }

    /// Not used: winding and normals of real sets disagree.
    void skipNormal() {
        const std::string word = lower(text_.wordOnLine());
        if (word.empty()) return;
        if (word != "normal") refuse(word, "'normal'");
        for (int k = 0; k < 3; ++k) text_.wordOnLine();
    }

    void readVertex() {
        std::array<float, 3> p{};
        for (float& value : p) value = static_cast<float>(text_.number(text_.word()));
        mesh_.faceVertices.push_back(table_.add({p[0], p[1], p[2]}));
        ++corners_;
    }

    const std::filesystem::path& path_;
    TextScanner text_;
    PointTable table_;
    RawMesh mesh_;
    std::uint32_t corners_ = 0;
    bool inSolid_ = false;
    bool inFacet_ = false;
};

/// Whether the content is a text of which the first word is 'solid'.
bool isText(std::string_view content) {
    if (content.find('\0') != content.npos) return false;
    const std::size_t begin = content.find_first_not_of(" \t\r\n\v\f");
    if (begin == content.npos) return false;
    const std::string_view word = content.substr(begin, 5);
    return lower(word) == "solid" &&
           (content.size() == begin + 5 || static_cast<unsigned char>(content[begin + 5]) <= ' ');
}

/// @throws Error for a file that is shorter than its number of triangles says, or so much longer
/// that the number cannot be right
void requireBinarySize(const std::filesystem::path& path, const std::string& bytes) {
    const std::uint32_t count = binaryCount(bytes);
    const std::size_t wanted = kHeaderBytes + kTriangleBytes * count;
    const std::string counted = fmt::format("{} triangles, which take {} bytes, in a file of {}",
                                            count, wanted, bytes.size());
    if (bytes.size() < wanted)
        throwFileError(
            path, fmt::format(
                      "truncated, or neither STL text (no 'solid' at the start) nor binary STL: {}",
                      counted));
    const std::size_t rest = bytes.size() - wanted;
    if (count == 0 || (rest > 0 && rest % kTriangleBytes == 0))
        throwFileError(path,
                       fmt::format("binary STL with a wrong number of triangles: {}", counted));
}

}  // namespace

RawMesh readStl(const std::filesystem::path& path) {
    const std::string bytes = readFileBytes(path);
    // Many binary files start with "solid" all the same, so the size decides first.
    if (bytes.size() > kHeaderBytes &&
        bytes.size() == kHeaderBytes + kTriangleBytes * binaryCount(bytes))
        return readBinary(bytes);
    if (std::string text(withoutByteOrderMark(path, bytes)); isText(text)) {
        useLineFeeds(text);
        return StlText(path, text).read();
    }
    if (bytes.size() < kHeaderBytes)
        throwFileError(path,
                       fmt::format("{} bytes without 'solid' at the start, expected an STL file",
                                   bytes.size()));
    requireBinarySize(path, bytes);
    RawMesh mesh = readBinary(bytes);
    mesh.remarks["bytes after the last triangle of a binary STL file, left out"] =
        bytes.size() - kHeaderBytes - kTriangleBytes * binaryCount(bytes);
    return mesh;
}

}  // namespace shadowcache
