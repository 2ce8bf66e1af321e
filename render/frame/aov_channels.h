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

/// R, G, B, the coverage as A if the film is transparent, and the channels of the AOVs named, for
/// writeExr.
///
/// @throws Error naming the AOVs there are
std::vector<Channel> channels(const Film& film, const std::vector<std::string>& aovs);

}  // namespace shadowcache
