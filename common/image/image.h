#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "common/math/vec.h"

namespace shadowcache {

/// Linear RGB picture, row 0 at the top, `pixels[y * width + x]`.
struct Image {
    int width = 0;
    int height = 0;
    std::vector<Rgb> pixels;
};

/// Image read for use as radiance, and what had to be mended.
struct RadianceImage {
    Image image;
    Rgb luminanceWeights{0.2126f, 0.7152f,
                         0.0722f};  ///< from the EXR's chromaticities if it has them
    std::size_t notFinite = 0;      ///< NaN and Inf texels, set to 0
    std::size_t negative = 0;       ///< texels with a negative channel, that channel set to 0
};

/// Reads radiance from OpenEXR (scan lines or tiles, one part or the first of several with colour,
/// half, float or uint channels, R G B [A], Y alone or Y RY BY, data window anywhere) or Radiance
/// HDR; told apart by content, not by name.
///
/// @throws Error naming the file and the cause
RadianceImage readRadiance(const std::filesystem::path& path);

/// A named set of planes of one picture, all width * height floats; the name is the EXR channel's
/// ("R", "irradiance.G", "depth.Z").
struct Channel {
    std::string name;
    std::vector<float> values;
};

/// Value of one metadata attribute of an EXR file.
using Metadata = std::vector<std::pair<std::string, std::string>>;

enum class PixelType { half, full };

/// Writes a scan-line EXR (ZIP), beside the target first, then renamed: never half a file.
///
/// @throws Error if it cannot be written (directory missing, disk full)
void writeExr(const std::filesystem::path& path, int width, int height,
              const std::vector<Channel>& channels, const Metadata& metadata, PixelType type);

/// Reads back every channel and every string attribute of an EXR file.
///
/// @throws Error
struct ExrFile {
    int width = 0;
    int height = 0;
    std::vector<Channel> channels;
    std::map<std::string, std::string> metadata;
};
ExrFile readExr(const std::filesystem::path& path);

/// The bytes of an 8-bit sRGB PNG of pixels * 2^exposure, clamped.
std::string encodePng(const Image& image, float exposure);

/// Writes an 8-bit sRGB PNG of pixels * 2^exposure, clamped; written beside, then renamed.
void writePng(const std::filesystem::path& path, const Image& image, float exposure);

}  // namespace shadowcache
