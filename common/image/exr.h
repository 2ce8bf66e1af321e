#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace shadowcache {

/// A named set of planes of one picture, all width * height floats; the name is the EXR channel's
/// ("R", "irradiance.G", "depth.Z").
struct Channel {
    std::string name;
    std::vector<float> values;
};

/// Value of one metadata attribute of an EXR file.
using Metadata = std::vector<std::pair<std::string, std::string>>;

enum class PixelType { half, full };

/// Where a picture's pixels stand in the whole frame.
struct ExrPlace {
    int x = 0, y = 0;                     ///< of the upper left pixel
    int frameWidth = 0, frameHeight = 0;  ///< 0: the picture is the whole frame
};

/// Chromaticities of red, green, blue and white: x and y of each.
using Chromaticities = std::array<float, 8>;

/// A matrix that points, as rows with a fourth number 1, are multiplied by; row by row.
using PointMatrix = std::array<float, 16>;

/// How a picture came to be, as OpenEXR's standard attributes say it.
struct ExrView {
    float pixelAspect = 1;                    ///< width of a pixel over its height
    std::array<float, 2> screenCenter{0, 0};  ///< of the screen window at distance 1; left and up
    float screenWidth = 1;                    ///< of that window
    std::optional<PointMatrix> worldToCamera{};  ///< to the right, upward and along the view
    std::optional<PointMatrix> worldToNdc{};     ///< 0, 0 to 1, 1: upper left to lower right corner
    double framesPerSecond = 0;                  ///< 0: unknown
    std::optional<Chromaticities> chromaticities{};  ///< none: Rec. 709
};

/// Writes a scan-line EXR (ZIP) whose data window is the picture and whose display window is the
/// frame; beside the target first, then renamed: never half a file.
///
/// @throws Error if it cannot be written (directory missing, disk full)
void writeExr(const std::filesystem::path& path, int width, int height,
              const std::vector<Channel>& channels, const Metadata& metadata, PixelType type,
              const ExrPlace& place = {}, const ExrView& view = {});

/// Reads back every channel, every string attribute and the view of an EXR file.
///
/// @throws Error
struct ExrFile {
    int width = 0;
    int height = 0;
    ExrPlace place;
    std::vector<Channel> channels;
    std::map<std::string, std::string> metadata;
    ExrView view{};
};
ExrFile readExr(const std::filesystem::path& path);

}  // namespace shadowcache
