#pragma once

#include <string_view>

namespace shadowcache {

/// Whether JSON text is nested no deeper than a recursive parser's stack bears.
inline bool isShallowJson(std::string_view text) {
    constexpr int kMostLevels = 256;
    int depth = 0;
    bool quoted = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (quoted && c == '\\')
            ++i;
        else if (c == '"')
            quoted = !quoted;
        else if (!quoted && (c == '[' || c == '{') && ++depth > kMostLevels)
            return false;
        else if (!quoted && (c == ']' || c == '}'))
            --depth;
    }
    return true;
}

}  // namespace shadowcache
