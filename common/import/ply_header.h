#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace shadowcache {

/// Number types of PLY, in any of their two spellings.
enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

std::size_t byteCount(PlyType type);

struct PlyProperty {
    std::string name;
    PlyType type = PlyType::float32;
    bool isList = false;
    PlyType countType = PlyType::uint8;  ///< of a list
};

struct PlyElement {
    std::string name;
    std::size_t count = 0;
    std::vector<PlyProperty> properties;

    /// Place of the first property with one of the two names, or -1.
    int find(std::string_view name, std::string_view otherName = {}) const;
    /// Places of red, green and blue under any of the names that programs give them; -1 for each
    /// that is not there.
    std::array<int, 3> findColor() const;
};

struct PlyHeader {
    enum class Encoding { text, littleEndian, bigEndian };
    Encoding encoding = Encoding::text;
    std::vector<PlyElement> elements;
    std::size_t bytes = 0;  ///< length of the header, its last line break included
    std::size_t lines = 0;
    std::size_t pictures = 0;  ///< that comments name ("TextureFile"); they are not read
};

/// Parses the header at the start of `content` and makes sure that what it announces can fit.
///
/// @throws Error if it is no PLY of version 1.0 or the rest is too short for its counts
PlyHeader parsePlyHeader(const std::filesystem::path& path, std::string_view content);

}  // namespace shadowcache
