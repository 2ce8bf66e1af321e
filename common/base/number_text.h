#pragma once

#include <fmt/core.h>

#include <cstdlib>
#include <string>

namespace shadowcache {

/// A number as it was typed would be: the shortest text that reads back.
inline std::string numberText(double value) {
    std::string text = fmt::format("{:g}", value);
    if (std::strtod(text.c_str(), nullptr) == value) return text;
    return fmt::format("{:.17g}", value);
}

}  // namespace shadowcache
