#include "common/import/ply_header.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <utility>

#include "common/base/error.h"
#include "common/base/file_bytes.h"

namespace shadowcache {

namespace {

constexpr std::array<std::pair<std::string_view, PlyType>, 16> kTypeNames{{
    {"char", PlyType::int8},
    {"int8", PlyType::int8},
    {"uchar", PlyType::uint8},
    {"uint8", PlyType::uint8},
    {"short", PlyType::int16},
    {"int16", PlyType::int16},
    {"ushort", PlyType::uint16},
    {"uint16", PlyType::uint16},
    {"int", PlyType::int32},
    {"int32", PlyType::int32},
    {"uint", PlyType::uint32},
    {"uint32", PlyType::uint32},
    {"float", PlyType::float32},
    {"float32", PlyType::float32},
    {"double", PlyType::float64},
    {"float64", PlyType::float64},
}};

PlyType parseType(TextScanner& text) {
    const std::string_view word = text.wordOnLine();
    for (const auto& [name, type] : kTypeNames) {
        if (word == name) return type;
    }
    text.fail("PLY type '" + std::string(word.substr(0, 20)) + "', expected char ... double");
}

PlyHeader::Encoding parseFormat(TextScanner& text) {
    const std::string_view name = text.wordOnLine();
    const std::string_view version = text.wordOnLine();
    if (version != "1.0") {
        text.fail("PLY format version " + std::string(version.substr(0, 20)) + ", expected 1.0");
    }
    if (name == "ascii") return PlyHeader::Encoding::text;
    if (name == "binary_little_endian") return PlyHeader::Encoding::littleEndian;
    if (name == "binary_big_endian") return PlyHeader::Encoding::bigEndian;
    text.fail("PLY format '" + std::string(name.substr(0, 30)) +
              "', expected ascii, binary_little_endian or binary_big_endian");
}

PlyElement parseElement(TextScanner& text) {
    PlyElement element;
    element.name = text.wordOnLine();
    const long long count = text.integer(text.wordOnLine());
    if (count < 0) text.fail(fmt::format("element count {}, expected 0 or more", count));
    element.count = static_cast<std::size_t>(count);
    return element;
}

PlyProperty parseProperty(TextScanner& text) {
    PlyProperty property;
    TextScanner ahead = text;
    property.isList = ahead.wordOnLine() == "list";
    if (property.isList) {
        text.wordOnLine();
        property.countType = parseType(text);
        if (property.countType == PlyType::float32 || property.countType == PlyType::float64) {
            text.fail("list counted by a float, expected a whole number type");
        }
    }
    property.type = parseType(text);
    property.name = text.wordOnLine();
    return property;
}

/// Fewest bytes that one row of the element takes.
std::size_t leastRowBytes(const PlyElement& element, PlyHeader::Encoding encoding) {
    std::size_t bytes = 0;
    for (const PlyProperty& property : element.properties) {
        if (encoding == PlyHeader::Encoding::text) {
            bytes += 2;  // a digit and a blank
        } else {
            bytes += byteCount(property.isList ? property.countType : property.type);
        }
    }
    return bytes;
}

void requireRoom(const std::filesystem::path& path, const PlyHeader& header, std::size_t bytes) {
    double needed = header.encoding == PlyHeader::Encoding::text ? -1.0 : 0.0;
    std::string counts;
    for (const PlyElement& element : header.elements) {
        needed += static_cast<double>(element.count) *
                  static_cast<double>(leastRowBytes(element, header.encoding));
        counts += fmt::format("{}{} {}", counts.empty() ? "" : ", ", element.count, element.name);
    }
    if (needed > static_cast<double>(bytes)) {
        throwFileError(path, fmt::format("truncated: {} bytes after the header cannot hold its {}",
                                         bytes, counts));
    }
}

}  // namespace

std::size_t byteCount(PlyType type) {
    switch (type) {
        case PlyType::int8:
        case PlyType::uint8:
            return 1;
        case PlyType::int16:
        case PlyType::uint16:
            return 2;
        case PlyType::float64:
            return 8;
        default:
            return 4;
    }
}

int PlyElement::find(std::string_view wanted, std::string_view otherName) const {
    for (std::size_t i = 0; i < properties.size(); ++i) {
        const std::string& found = properties[i].name;
        if (found == wanted || (!otherName.empty() && found == otherName)) {
            return static_cast<int>(i);
        }
    }
    return -1;
}

std::array<int, 3> PlyElement::findColor() const {
    for (const std::string_view prefix : {"", "diffuse_"}) {
        std::array<int, 3> places{};
        constexpr std::array<std::string_view, 3> kNames{"red", "green", "blue"};
        for (std::size_t k = 0; k < kNames.size(); ++k)
            places[k] = find(std::string(prefix).append(kNames[k]),
                             prefix.empty() ? kNames[k].substr(0, 1) : std::string_view());
        if (std::ranges::count(places, -1) == 0) return places;
    }
    return {-1, -1, -1};
}

PlyHeader parsePlyHeader(const std::filesystem::path& path, std::string_view content) {
    PlyHeader header;
    TextScanner text(path, content, false);
    if (text.wordOnLine() != "ply")
        throwFileError(path, "does not start with 'ply', expected a PLY file");
    bool hasFormat = false;
    while (true) {
        if (!text.nextLine()) throwFileError(path, "truncated: ends within the PLY header");
        const std::string_view keyword = text.wordOnLine();
        if (keyword == "end_header") break;
        if (keyword == "comment") {
            header.pictures += text.wordOnLine() == "TextureFile" ? 1 : 0;
            continue;
        }
        if (keyword == "format") {
            header.encoding = parseFormat(text);
            hasFormat = true;
        } else if (keyword == "element") {
            header.elements.push_back(parseElement(text));
        } else if (keyword == "property") {
            if (header.elements.empty()) text.fail("property before the first element");
            header.elements.back().properties.push_back(parseProperty(text));
        } else if (!keyword.empty() && keyword != "obj_info") {
            text.fail(std::string(keyword.substr(0, 20)) + ": expected a PLY header line");
        }
    }
    if (!hasFormat) throwFileError(path, "PLY header without a format line");
    text.nextLine();
    header.lines = text.line() - 1;
    header.bytes = content.size() - text.bytesLeft();
    requireRoom(path, header, text.bytesLeft());
    return header;
}

}  // namespace shadowcache
