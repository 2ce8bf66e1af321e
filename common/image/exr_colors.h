#pragma once

// Private to the files that see OpenEXR.

#include <OpenEXR/ImfMultiPartInputFile.h>

#include <filesystem>
#include <string>
#include <vector>

namespace shadowcache {

/// Which channels of an OpenEXR file are its colours.
struct ExrColors {
    int part = 0;
    std::vector<std::string> channels;  ///< red, green, blue; or Y; or Y, RY, BY
    std::string note;  ///< which channels were chosen, where the file leaves a choice
};

/// Chooses, in this order: R G B of the first flat part that has them; Y, with RY and BY if they
/// are there; the colours of a named layer ("ViewLayer.Combined.R", "rgba.red"), if there is one,
/// or one of the first view that is named as the main picture is. Red is R, r or red.
///
/// @throws Error naming the channels, or the layers of which none is the main one
ExrColors chooseColors(const std::filesystem::path& path, const Imf::MultiPartInputFile& file);

}  // namespace shadowcache
