#include "common/import/lamp_gain.h"

#include <fmt/core.h>

#include <algorithm>

#include "common/base/error.h"
#include "common/base/option_checks.h"
#include "common/base/option_text.h"
#include "common/base/suggestion.h"

namespace shadowcache {

LampGain parseLampGain(const std::string& text, const std::string& option) try {
    // Names may have an equals sign, gains have none.
    const std::size_t sign = text.rfind('=');
    if (sign == std::string::npos || sign == 0) throw Error("no name");
    const std::vector<double> n = numbersOf(option, text.substr(sign + 1), {1, 3}, "numbers");
    for (const double gain : n) requireRange(option.c_str(), gain, 0.0, 1e6);
    return {text.substr(0, sign), Rgb(n.size() == 1 ? Vec3d(n[0]) : Vec3d(n[0], n[1], n[2]))};
} catch (const Error&) {
    refuseText(option, text, "NAME= and a factor, or R,G,B, 0 to 1e6");
}

bool matchesPattern(std::string_view pattern, std::string_view name) {
    std::size_t p = 0, n = 0;
    // The last star, and how much of the name is left to what follows it.
    std::size_t star = pattern.npos, rest = 0;
    while (n < name.size()) {
        if (p < pattern.size() && pattern[p] == '*') {
            star = p++;
            rest = n;
        } else if (p < pattern.size() && pattern[p] == name[n]) {
            ++p;
            ++n;
        } else if (star != pattern.npos) {
            p = star + 1;
            n = ++rest;
        } else {
            return false;
        }
    }
    return pattern.find_first_not_of('*', p) == pattern.npos;
}

Rgb lampGainOf(std::string_view name, std::span<const LampGain> gains) {
    Rgb gain(1.0f);
    for (const LampGain& lamp : gains)
        if (matchesPattern(lamp.pattern, name)) gain = lamp.gain;
    return gain;
}

void applyGains(std::span<const LampGain> gains, TriangleMesh& mesh) {
    for (Lamp& lamp : mesh.lamps) lamp.gain = lampGainOf(lamp.name, gains);
    for (Material& material : mesh.materials)
        material.finish.gain = lampGainOf(material.name, gains);
}

std::vector<std::string> lampNames(const TriangleMesh& mesh) {
    std::vector<std::string> names;
    for (const Lamp& lamp : mesh.lamps) names.push_back(lamp.name);
    for (const Material& material : mesh.materials)
        if (material.finish.emission != Rgb(0, 0, 0)) names.push_back(material.name);
    return names;
}

void requireMatches(std::span<const LampGain> gains, std::span<const std::string> names) {
    for (const LampGain& lamp : gains)
        if (std::ranges::none_of(
                names, [&](const std::string& name) { return matchesPattern(lamp.pattern, name); }))
            throw Error(fmt::format("--lamp {}: no lamp or emissive material of this name{}",
                                    lamp.pattern, suggestion(lamp.pattern, names)));
}

}  // namespace shadowcache
