#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "render/frame/film.h"

namespace shadowcache {

/// Those of the AOVs named that are drawn in false colour beside a PNG, with their files:
/// "frame.png" has "frame.openness.png".
std::vector<std::pair<std::string, std::filesystem::path>> aovPictures(
    const std::filesystem::path& png, const std::vector<std::string>& aovs);

/// An AOV in false colour, the sky black.
Image falseColorImage(const Film& film, const std::string& aov);

}  // namespace shadowcache
