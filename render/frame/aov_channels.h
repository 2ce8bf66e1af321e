#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/image/exr.h"
#include "render/frame/film.h"

namespace shadowcache {

/// Names that channels() accepts.
const std::vector<std::string>& aovNames();

/// How an AOV is drawn in false colour.
struct AovScale {
    float most;  ///< value of the brightest colour; 0: the highest in the picture, about
    float (*value)(const Pixel&);  ///< what is drawn
};

/// Nothing for an AOV that is no false-colour picture.
std::optional<AovScale> aovScale(const std::string& name);

/// Whether an AOV shows what the cache predicts (RenderOptions::insight).
bool needsInsight(const std::string& aov);

/// R, G, B, alpha as A if the film is transparent, R, G and B of each light group, and the
/// channels of the AOVs named, for writeExr.
///
/// @throws Error naming the AOVs there are
std::vector<Channel> channels(const Film& film, const std::vector<std::string>& aovs);

/// The metadata of a picture that names its light groups, without a program's prefix.
inline constexpr const char* kGroupsKey = "groups";

/// The names of light groups as a text.
std::string groupsText(const std::vector<std::string>& groups);

/// The names that such a text has.
std::vector<std::string> groupsOf(const std::string& text);

}  // namespace shadowcache
