#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <utility>

#include "common/base/error.h"
#include "common/base/file_bytes.h"
#include "common/image/srgb.h"
#include "common/import/face_colors.h"
#include "common/import/mesh_reader.h"
#include "common/import/ply_header.h"

namespace shadowcache {

namespace {

/// Numbers of a text body, one after the other whatever the line breaks.
class TextNumbers {
public:
    TextNumbers(const std::filesystem::path& path, std::string_view body, std::size_t firstLine)
        : path_(path), text_(path, body, false, firstLine) {}

    double next(PlyType) {
        const std::string_view word = text_.word();
        if (word.empty()) throwFileError(path_, "truncated: text ends within the data");
        return text_.number(word);
    }
    /// Most numbers that can follow.
    std::size_t room(PlyType) const { return text_.bytesLeft() / 2 + 1; }

private:
    std::filesystem::path path_;
    TextScanner text_;
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
    std::size_t room(PlyType type) const { return (body_.size() - at_) / byteCount(type); }

private:
    std::filesystem::path path_;
    std::string_view body_;
    std::size_t at_ = 0;
    bool swap_;
};

template <class Numbers>
std::size_t nextListSize(const std::filesystem::path& path, Numbers& numbers,
                         const PlyProperty& property) {
    const double size = numbers.next(property.countType);
    if (!(size >= 0.0 && size <= static_cast<double>(numbers.room(property.type)))) {
        throwFileError(path, "truncated or damaged: list '" + property.name + "' of " +
                                 std::to_string(size) + " values, at most " +
                                 std::to_string(numbers.room(property.type)) + " follow");
    }
    return static_cast<std::size_t>(size);
}

/// Whole numbers hold 8- or 16-bit sRGB, floats are linear as they stand.
float linearColor(double value, PlyType type) {
    const auto number = static_cast<float>(value);
    if (type == PlyType::float32 || type == PlyType::float64) return number;
    return srgbToLinear(number / (byteCount(type) == 1 ? 255.0f : 65535.0f));
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
        mesh.vertices.emplace_back(row[0], row[1], row[2]);
        if (smooth) mesh.normals.emplace_back(row[6], row[7], row[8]);
        if (!colored) continue;
        const auto channel = [&](std::size_t c) {
            const auto place = static_cast<std::size_t>(places[c]);
            return linearColor(row[c], element.properties[place].type);
        };
        mesh.colors.emplace_back(channel(3), channel(4), channel(5));
    }
}

std::uint32_t vertexNumber(double value) {
    const bool valid = value >= 0.0 && value < static_cast<double>(kNoVertex);
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
    if (colored) faceColors.resize(mesh.faceSizes.size(), kUncolored);
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
                if (channel < 3) rgb[static_cast<int>(channel)] = linearColor(value, property.type);
                if (corners) mesh.faceVertices.push_back(vertexNumber(value));
            }
            if (corners) mesh.faceSizes.push_back(static_cast<std::uint32_t>(size));
        }
        if (colored) faceColors.push_back(rgb);
    }
}

/// Triangle strips, one list of corners each: -1 ends a strip, and the next begins.
template <class Numbers>
void readStrips(const std::filesystem::path& path, Numbers& numbers, const PlyElement& element,
                RawMesh& mesh) {
    const int place = element.find("vertex_indices", "vertex_index");
    if (place < 0 || !element.properties[static_cast<std::size_t>(place)].isList)
        throwFileError(path, "triangle strips lack the list vertex_indices");
    for (std::size_t i = 0; i < element.count; ++i)
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
}

template <class Numbers>
void skipRows(const std::filesystem::path& path, Numbers& numbers, const PlyElement& element) {
    for (std::size_t i = 0; i < element.count && !element.properties.empty(); ++i) {
        for (const PlyProperty& property : element.properties) {
            const std::size_t size = property.isList ? nextListSize(path, numbers, property) : 1;
            for (std::size_t j = 0; j < size; ++j) numbers.next(property.type);
        }
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
        }
    }
    if (!hasFaces)
        throwFileError(path, "PLY without faces (a point cloud?), expected faces or tristrips");
    if (!faceColors.empty()) colorFaces(faceColors, mesh);
    return mesh;
}

}  // namespace

RawMesh readPly(const std::filesystem::path& path) {
    const std::string bytes = readFileBytes(path);
    const PlyHeader header = parsePlyHeader(path, bytes);
    const std::string_view body = std::string_view(bytes).substr(header.bytes);
    if (header.encoding == PlyHeader::Encoding::text) {
        return readBody(path, header, TextNumbers(path, body, header.lines + 1));
    }
    const bool fileIsLittle = header.encoding == PlyHeader::Encoding::littleEndian;
    const bool swap = fileIsLittle != (std::endian::native == std::endian::little);
    return readBody(path, header, BinaryNumbers(path, body, swap));
}

}  // namespace shadowcache
