#pragma once

#include <charconv>
#include <string_view>

namespace shadowcache {

// What an option's text is read with, from its front on: each takes what it finds.

/// Whether a whole number of `int` was there.
inline bool takeNumber(std::string_view& text, int& number) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc()) return false;
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    return true;
}

/// Whether this character was there.
inline bool takeCharacter(std::string_view& text, char c) {
    if (!text.starts_with(c)) return false;
    text.remove_prefix(1);
    return true;
}

}  // namespace shadowcache
