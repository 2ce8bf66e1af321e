#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <span>
#include <utility>

#include "common/base/error.h"
#include "common/base/file_bytes.h"
#include "common/base/report_failure.h"
#include "common/import/face_colors.h"
#include "common/import/mesh_reader.h"
#include "common/import/ply_header.h"
#include "common/import/vertex_colors.h"

namespace shadowcache {

namespace {

/// Numbers of a text body. A row begins a line; one that goes on in the next is read, too.
class TextNumbers {
public:
    TextNumbers(const std::filesystem::path& path, std::string_view body, std::size_t firstLine)
        : path_(path), text_(path, body, false, firstLine) {}

    double next(PlyType) {
        std::string_view word = text_.wordOnLine();
        if (word.empty()) {
            if (inRow_ && shortLine_ == 0) shortLine_ = text_.line();
            word = text_.word();
        }
        if (word.empty())
            throwFileError(path_, "truncated: text ends within the data" + shortRow());
        inRow_ = true;
        return text_.number(word);
    }
    void endRow(const PlyElement& element) {
        inRow_ = false;
        if (!text_.atLineEnd())
            text_.fail(
                fmt::format("row of '{}' with more numbers than its {} properties in the header{}",
                            element.name, element.properties.size(), shortRow()));
    }
    void finish() {
        const std::string_view word = text_.word();
        if (!word.empty())
            text_.fail("text after the last row that the header counts, expected none" +
                       shortRow());
    }
    /// Most numbers that can follow.
    std::size_t room(PlyType) const { return text_.bytesLeft() / 2 + 1; }

private:
    /// The cause of what is found later, if a row was too short.
    std::string shortRow() const {
        return shortLine_ == 0
                   ? ""
                   : fmt::format(" (line {} has fewer numbers than the header says)", shortLine_);
    }

    std::filesystem::path path_;
    TextScanner text_;
    bool inRow_ = false;
    std::size_t shortLine_ = 0;  ///< the first that ends within its row; 0: none
};

template <class T>
double valueAt(const char* bytes, bool swap) {
    std::array<char, sizeof(T)> raw;
    std::memcpy(raw.data(), bytes, sizeof(T));
    if (swap) {
        for (std::size_t i = 0; i < sizeof(T) / 2; ++i) std::swap(raw[i], raw[sizeof(T) - 1 - i]);
    }
    return static_cast<double>(std::bit_cast<T>(raw));
}

/// Numbers of a binary body.
class BinaryNumbers {
public:
    BinaryNumbers(const std::filesystem::path& path, std::string_view body, bool swap)
        : path_(path), body_(body), swap_(swap) {}

    double next(PlyType type) {
        const std::size_t size = byteCount(type);
        if (body_.size() - at_ < size) throwFileError(path_, "truncated: ends within the data");
        const char* bytes = body_.data() + at_;
        at_ += size;
        switch (type) {
            case PlyType::int8:
                return valueAt<std::int8_t>(bytes, false);
            case PlyType::uint8:
                return valueAt<std::uint8_t>(bytes, false);
            case PlyType::int16:
                return valueAt<std::int16_t>(bytes, swap_);
            case PlyType::uint16:
                return valueAt<std::uint16_t>(bytes, swap_);
            case PlyType::int32:
                return valueAt<std::int32_t>(bytes, swap_);
            case PlyType::uint32:
                return valueAt<std::uint32_t>(bytes, swap_);
            case PlyType::float32:
                return static_cast<double>(valueAt<float>(bytes, swap_));
            case PlyType::float64:
                return valueAt<double>(bytes, swap_);
        }
        return 0.0;
    }
    void endRow(const PlyElement&) {}
    /// Some writers fill up with zeros or blanks.
    void finish() const {
        const std::string_view rest = body_.substr(at_);
        if (rest.find_first_not_of(std::string_view("\0\r\n\t ", 5)) != rest.npos)
            throwFileError(
                path_,
                fmt::format("{} bytes after the last row that the header counts, expected none",
                            rest.size()));
    }
    std::size_t room(PlyType type) const { return (body_.size() - at_) / byteCount(type); }

private:
    std::filesystem::path path_;
    std::string_view body_;
    std::size_t at_ = 0;
    bool swap_;
};

/// Reports the properties of an element but those at the places that are read; -1 is none.
void nameUnread(const PlyElement& element, std::span<const int> read, RawMesh& mesh) {
    constexpr std::size_t kMostNamed = 8, kMostBytes = 40;
    std::size_t count = 0;
    std::string names;
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
        if (std::ranges::find(read, static_cast<int>(i)) != read.end()) continue;
        if (++count > kMostNamed) continue;
        names += (count > 1 ? ", " : "") + element.properties[i].name.substr(0, kMostBytes);
    }
    if (count > kMostNamed) names += ", ...";
    if (count > 0 && element.count > 0)
        mesh.remarks[oneLine(fmt::format("properties of '{}' left out ({})",
                                         element.name.substr(0, kMostBytes), names))] = count;
}

template <class Numbers>
std::size_t nextListSize(const std::filesystem::path& path, Numbers& numbers,
                         const PlyProperty& property) {
    const double size = numbers.next(property.countType);
    if (!(size >= 0.0 && size <= static_cast<double>(numbers.room(property.type)))) {
        throwFileError(
            path, fmt::format("truncated or damaged: list '{}' of {:f} values, at most {} follow",
                              property.name, size, numbers.room(property.type)));
    }
    return static_cast<std::size_t>(size);
}

ColorNumbers colorNumbers(PlyType type) {
    if (type == PlyType::float32 || type == PlyType::float64) return ColorNumbers::any;
    return byteCount(type) == 1 ? ColorNumbers::bytes : ColorNumbers::whole;
}

template <class Numbers>
void readVertices(const std::filesystem::path& path, Numbers& numbers, const PlyElement& element,
                  RawMesh& mesh) {
    constexpr std::size_t kChannels = 9;
    const std::array<int, 3> color = element.findColor();
    const std::array<int, kChannels> places{
        element.find("x"), element.find("y"),  element.find("z"),  color[0],          color[1],
        color[2],          element.find("nx"), element.find("ny"), element.find("nz")};
    if (places[0] < 0 || places[1] < 0 || places[2] < 0) {
        throwFileError(path, "vertices lack one of the properties x, y, z");
    }
    const bool colored = places[3] >= 0 && places[4] >= 0 && places[5] >= 0;
    const bool smooth = places[6] >= 0 && places[7] >= 0 && places[8] >= 0;
    std::vector<std::size_t> channelOf(element.properties.size(), kChannels);
    for (std::size_t i = 0; i < kChannels; ++i) {
        if (places[i] >= 0) channelOf[static_cast<std::size_t>(places[i])] = i;
    }

    std::vector<int> read{places[0], places[1], places[2], color[0], color[1], color[2]};
    if (smooth) read.insert(read.end(), {places[6], places[7], places[8]});
    nameUnread(element, read, mesh);

    ColorScale scale(
        colored ? colorNumbers(element.properties[static_cast<std::size_t>(places[3])].type)
                : ColorNumbers::any);
    mesh.vertices.reserve(element.count);
    if (colored) mesh.colors.reserve(element.count);
    if (smooth) mesh.normals.reserve(element.count);
    std::array<double, kChannels + 1> row{};
    for (std::size_t i = 0; i < element.count; ++i) {
        for (std::size_t k = 0; k < element.properties.size(); ++k) {
            const PlyProperty& property = element.properties[k];
            const std::size_t size = property.isList ? nextListSize(path, numbers, property) : 1;
            for (std::size_t j = 0; j < size; ++j) row[channelOf[k]] = numbers.next(property.type);
        }
        numbers.endRow(element);
        mesh.vertices.emplace_back(row[0], row[1], row[2]);
        if (smooth) mesh.normals.emplace_back(row[6], row[7], row[8]);
        if (!colored) continue;
        for (std::size_t c = 3; c < 6; ++c) scale.see(row[c]);
        mesh.colors.emplace_back(static_cast<float>(row[3]), static_cast<float>(row[4]),
                                 static_cast<float>(row[5]));
    }
    mesh.badColors += decodeColors(scale, mesh.colors);
}

std::uint32_t vertexNumber(double value) {
    const bool valid = value >= 0.0 && value < static_cast<double>(kNoVertex) &&
                       value == std::floor(value);  // it may be of a float type
    return valid ? static_cast<std::uint32_t>(value) : kNoVertex;
}

/// @param faceColors  receives the faces' colours if they have any
template <class Numbers>
void readFaces(const std::filesystem::path& path, Numbers& numbers, const PlyElement& element,
               RawMesh& mesh, std::vector<Rgb>& faceColors) {
    const int place = element.find("vertex_indices", "vertex_index");
    if (element.count > 0 &&
        (place < 0 || !element.properties[static_cast<std::size_t>(place)].isList)) {
        throwFileError(path, "faces lack the list vertex_indices");
    }
    const std::array<int, 3> color = element.findColor();
    const bool colored = color[0] >= 0;
    nameUnread(element, std::array{place, color[0], color[1], color[2]}, mesh);
    ColorScale scale(colored
                         ? colorNumbers(element.properties[static_cast<std::size_t>(color[0])].type)
                         : ColorNumbers::any);
    std::vector<Rgb> colors;
    const std::size_t facesBefore = mesh.faceSizes.size();
    mesh.faceSizes.reserve(element.count);
    mesh.faceVertices.reserve(element.count * 3);
    for (std::size_t i = 0; i < element.count; ++i) {
        Rgb rgb = kUncolored;
        for (std::size_t k = 0; k < element.properties.size(); ++k) {
            const PlyProperty& property = element.properties[k];
            const std::size_t size = property.isList ? nextListSize(path, numbers, property) : 1;
            const bool corners = static_cast<int>(k) == place;
            const auto channel = std::ranges::find(color, static_cast<int>(k)) - color.begin();
            for (std::size_t j = 0; j < size; ++j) {
                const double value = numbers.next(property.type);
                if (channel < 3) {
                    scale.see(value);
                    rgb[static_cast<int>(channel)] = static_cast<float>(value);
                }
                if (corners) mesh.faceVertices.push_back(vertexNumber(value));
            }
            if (corners) mesh.faceSizes.push_back(static_cast<std::uint32_t>(size));
        }
        numbers.endRow(element);
        if (colored) colors.push_back(rgb);
    }
    if (!colored) return;
    mesh.badColors += decodeColors(scale, colors);
    faceColors.resize(facesBefore, kUncolored);
    faceColors.insert(faceColors.end(), colors.begin(), colors.end());
}

/// Triangle strips, one list of corners each: -1 ends a strip, and the next begins.
template <class Numbers>
void readStrips(const std::filesystem::path& path, Numbers& numbers, const PlyElement& element,
                RawMesh& mesh) {
    const int place = element.find("vertex_indices", "vertex_index");
    if (place < 0 || !element.properties[static_cast<std::size_t>(place)].isList)
        throwFileError(path, "triangle strips lack the list vertex_indices");
    nameUnread(element, std::array{place}, mesh);
    for (std::size_t i = 0; i < element.count; ++i) {
        for (std::size_t k = 0; k < element.properties.size(); ++k) {
            const PlyProperty& property = element.properties[k];
            const std::size_t size = property.isList ? nextListSize(path, numbers, property) : 1;
            std::array<std::uint32_t, 2> last{};
            std::size_t length = 0;  // of the strip so far
            for (std::size_t j = 0; j < size; ++j) {
                const double value = numbers.next(property.type);
                if (static_cast<int>(k) != place) continue;
                if (value == -1) {
                    length = 0;
                    continue;
                }
                const std::uint32_t corner = vertexNumber(value);
                if (length++ >= 2) {
                    const std::size_t odd = length % 2 == 0 ? 1 : 0;
                    mesh.faceVertices.insert(mesh.faceVertices.end(),
                                             {last[odd], last[1 - odd], corner});
                    mesh.faceSizes.push_back(3);
                }
                last = {last[1], corner};
            }
        }
        numbers.endRow(element);
    }
}

template <class Numbers>
void skipRows(const std::filesystem::path& path, Numbers& numbers, const PlyElement& element) {
    for (std::size_t i = 0; i < element.count && !element.properties.empty(); ++i) {
        for (const PlyProperty& property : element.properties) {
            const std::size_t size = property.isList ? nextListSize(path, numbers, property) : 1;
            for (std::size_t j = 0; j < size; ++j) numbers.next(property.type);
        }
        numbers.endRow(element);
    }
}

template <class Numbers>
RawMesh readBody(const std::filesystem::path& path, const PlyHeader& header, Numbers numbers) {
    RawMesh mesh;
    std::vector<Rgb> faceColors;
    bool hasFaces = false;
    for (const PlyElement& element : header.elements) {
        if (element.name == "vertex") {
            readVertices(path, numbers, element, mesh);
        } else if (element.name == "face") {
            readFaces(path, numbers, element, mesh, faceColors);
            hasFaces = true;
        } else if (element.name == "tristrips") {
            readStrips(path, numbers, element, mesh);
            hasFaces = true;
        } else {
            skipRows(path, numbers, element);
            nameUnread(element, {}, mesh);
        }
    }
    numbers.finish();
    if (!hasFaces)
        throwFileError(path, "PLY without faces (a point cloud?), expected faces or tristrips");
    if (!faceColors.empty()) colorFaces(faceColors, mesh);
    if (header.pictures > 0)
        mesh.remarks["pictures of TextureFile comments left out"] = header.pictures;
    return mesh;
}

/// Those of the header, and of a text body.
void mendLineBreaks(std::string& bytes) {
    const std::size_t end = bytes.find("end_header");
    if (end == bytes.npos) return;
    const bool isText = bytes.find("format ascii") < end;
    useLineFeeds(bytes, isText ? bytes.npos : end + std::string_view("end_header\r").size());
}

}  // namespace

RawMesh readPly(const std::filesystem::path& path) {
    std::string bytes = readFileBytes(path);
    mendLineBreaks(bytes);
    const std::string_view content = withoutByteOrderMark(path, bytes);
    const PlyHeader header = parsePlyHeader(path, content);
    const std::string_view body = content.substr(header.bytes);
    if (header.encoding == PlyHeader::Encoding::text) {
        return readBody(path, header, TextNumbers(path, body, header.lines + 1));
    }
    const bool fileIsLittle = header.encoding == PlyHeader::Encoding::littleEndian;
    const bool swap = fileIsLittle != (std::endian::native == std::endian::little);
    return readBody(path, header, BinaryNumbers(path, body, swap));
}

}  // namespace shadowcache
