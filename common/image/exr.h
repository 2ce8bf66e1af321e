#pragma once

#include <filesystem>
#include <map>
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

}  // namespace shadowcache
