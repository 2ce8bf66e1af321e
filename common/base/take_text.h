#pragma once

#include <charconv>
#include <concepts>
#include <string_view>

namespace shadowcache {

// What an option's text is read with, from its front on: each takes what it finds.

/// Whether a number of its type was there.
template <class T>
requires std::same_as<T, int> || std::same_as<T, double>
bool takeNumber(std::string_view& text, T& number) {
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
