#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

namespace shadowcache {

/// Header of a Radiance picture. [Ward, "RADIANCE File Formats": Picture File Format]
struct HdrHeader {
    std::size_t width = 0;   ///< pixels
    std::size_t height = 0;  ///< pixels
    /// How the file's scan lines, and the pixels in them, go through the picture.
    bool byColumns = false;   ///< a scan line is a column
    bool fromRight = false;   ///< right to left
    bool fromBottom = false;  ///< bottom to top
    /// Of red, green, blue: the pixels were multiplied by it.
    std::array<double, 3> multiplier{1, 1, 1};
    /// x and y of red, green, blue and white.
    std::optional<std::array<float, 8>> primaries;
    std::optional<double> gamma;  ///< a line of some programs; not Radiance's
    std::size_t bytes = 0;        ///< length of the header
};

/// Parses the header at the start of `content`: lines up to an empty one, then the resolution.
///
/// @throws Error naming the file and the line: another format, numbers out of range
HdrHeader parseHdrHeader(const std::filesystem::path& path, const std::string& content);

}  // namespace shadowcache
