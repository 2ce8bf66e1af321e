#pragma once

#include <span>
#include <string>
#include <vector>

#include "common/mesh/mesh.h"

namespace shadowcache {

/// Lamps and materials that emit, whose light is to be kept apart.
struct LightGroupRule {
    std::string group;    ///< its name; empty: each name that the pattern matches is a group
    std::string pattern;  ///< of names, in which * stands for any text

    bool operator==(const LightGroupRule&) const = default;
};

/// "NAME", or "GROUP=NAME" with * in the name for any text, split at the first equals sign.
///
/// @throws Error naming --light-groups
LightGroupRule parseLightGroup(const std::string& text);

/// The group of the sky, and that of all that shines and is in no other.
inline constexpr const char* kSkyGroup = "sky";
inline constexpr const char* kRestGroup = "rest";

/// Most groups of a picture, with these two.
inline constexpr std::size_t kMostLightGroups = 64;

/// The names of the groups of a set: the sky's, those of the rules in their order, and the rest's.
///
/// @throws Error naming --light-groups: a pattern matches nothing, a name is taken or no layer's,
/// there are too many
std::vector<std::string> lightGroupNames(std::span<const LightGroupRule> rules,
                                         const TriangleMesh& mesh);

/// The group of what shines under a name: by the last rule that matches, else the rest.
///
/// @param groups  of lightGroupNames()
std::size_t lightGroupOf(const std::string& name, std::span<const LightGroupRule> rules,
                         std::span<const std::string> groups);

}  // namespace shadowcache
