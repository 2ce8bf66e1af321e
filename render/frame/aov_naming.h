#pragma once

#include <vector>

#include "common/base/named.h"
#include "common/image/exr.h"

namespace shadowcache {

/// Whose names the channels of AOVs have in a file.
enum class AovNaming { shadowcache, arnold };

/// Names accepted by --aov-names.
inline constexpr Named<AovNaming> kAovNamings[] = {{"shadowcache", AovNaming::shadowcache},
                                                   {"arnold", AovNaming::arnold}};

/// Renames the channels that the naming has names for. Arnold's are those that its denoiser noice
/// looks for: N for `normal`, Z for `axial_depth`, diffuse_albedo for `diffuse_color`, and
/// `variance`, of which it wants one for each colour: the luminance's, three times.
std::vector<Channel> named(std::vector<Channel> channels, AovNaming naming);

}  // namespace shadowcache
