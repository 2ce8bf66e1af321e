#include "common/import/light_group.h"

#include <fmt/core.h>

#include <algorithm>

#include "common/base/error.h"
#include "common/base/option_text.h"
#include "common/base/suggestion.h"
#include "common/import/lamp_gain.h"

namespace shadowcache {

namespace {

/// Bytes of a name, at most: it is that of a layer of an EXR file.
constexpr std::size_t kLongestName = 200;

/// Names of all that shines: of lamps, and of materials that emit or are unlit.
std::vector<std::string> shiningNames(const TriangleMesh& mesh) {
    std::vector<std::string> names = lampNames(mesh);
    for (const Material& material : mesh.materials)
        if (material.finish.unlit) names.push_back(material.name);
    return names;
}

[[noreturn]] void refuse(const std::string& text, const std::string& why) {
    throw Error(fmt::format("--light-groups {}: {}", text, why));
}

void requireLayerName(const std::string& name) {
    if (name.size() > kLongestName)
        refuse(name, fmt::format("is a name of {} bytes, expected at most {}", name.size(),
                                 kLongestName));
    if (std::ranges::any_of(name, [](char c) { return static_cast<unsigned char>(c) < ' '; }))
        throw Error(
            "--light-groups: the name of a lamp has a control character, expected none in that of "
            "a group");
    if (name == kSkyGroup || name == kRestGroup)
        refuse(name, fmt::format("is the group of {}; expected GROUP=NAME with another one",
                                 name == kSkyGroup ? "the sky" : "what is in no other"));
}

}  // namespace

LightGroupRule parseLightGroup(const std::string& text) {
    const std::size_t sign = text.find('=');
    LightGroupRule rule{sign == text.npos ? "" : text.substr(0, sign),
                        sign == text.npos ? text : text.substr(sign + 1)};
    if (rule.pattern.empty() || sign == 0)
        refuseText("light-groups", text,
                   "the name of a lamp, or GROUP=NAME; * stands for any text");
    if (sign != text.npos) requireLayerName(rule.group);
    return rule;
}

std::vector<std::string> lightGroupNames(std::span<const LightGroupRule> rules,
                                         const TriangleMesh& mesh) {
    const std::vector<std::string> shining = shiningNames(mesh);
    std::vector<std::string> groups{kSkyGroup};
    const auto add = [&groups](const std::string& name) {
        if (std::ranges::find(groups, name) == groups.end()) groups.push_back(name);
    };
    for (const LightGroupRule& rule : rules) {
        bool isMatched = false;
        for (const std::string& name : shining) {
            if (!matchesPattern(rule.pattern, name)) continue;
            isMatched = true;
            // What has no name is of the rest.
            if (!rule.group.empty() || name.empty()) continue;
            requireLayerName(name);
            add(name);
        }
        if (!isMatched)
            refuse(rule.pattern,
                   "no lamp or emissive material of this name" + suggestion(rule.pattern, shining));
        if (!rule.group.empty()) add(rule.group);
    }
    groups.emplace_back(kRestGroup);
    if (groups.size() > kMostLightGroups)
        throw Error(
            fmt::format("--light-groups: makes {} groups, expected at most {}: join some "
                        "by GROUP=NAME",
                        groups.size(), kMostLightGroups));
    return groups;
}

std::size_t lightGroupOf(const std::string& name, std::span<const LightGroupRule> rules,
                         std::span<const std::string> groups) {
    std::size_t group = groups.size() - 1;
    for (const LightGroupRule& rule : rules) {
        if (!matchesPattern(rule.pattern, name)) continue;
        // The first is the sky's, whatever a lamp is called.
        const auto found =
            std::find(groups.begin() + 1, groups.end(), rule.group.empty() ? name : rule.group);
        group = found == groups.end() ? groups.size() - 1
                                      : static_cast<std::size_t>(found - groups.begin());
    }
    return group;
}

}  // namespace shadowcache
