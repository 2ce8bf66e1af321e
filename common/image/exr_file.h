#pragma once

// Private to the files that see OpenEXR.

#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfMultiPartInputFile.h>

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace shadowcache {

/// Pixels of a window, at most.
inline constexpr double kMostExrPixels = 0x1p29;

/// Opens an OpenEXR file whose header is sound.
///
/// @throws Error for a file that is none, or a newer one
Imf::MultiPartInputFile openExr(const std::filesystem::path& path);

/// The data window of a part.
///
/// @throws Error if pixels are missing, or for one of more than 2^29 pixels
Imath::Box2i checkedWindow(const std::filesystem::path& path, const Imf::MultiPartInputFile& file,
                           int part);

bool isDeep(const Imf::Header& header);

/// @throws Error for a subsampled channel
void requireFullResolution(const std::filesystem::path& path, const std::string& name,
                           const Imf::Channel& channel);

/// Reads channels as float.
///
/// @param valueStride  bytes from one value of a channel to the next
/// @param target       the place of a channel's first value
void readChannels(Imf::MultiPartInputFile& file, int part, const std::vector<std::string>& names,
                  std::size_t valueStride, const std::function<float*(const std::string&)>& target);

}  // namespace shadowcache
