#include "common/base/utf8.h"

#include <cstddef>
#include <cstdint>

namespace shadowcache {

namespace {

/// Bytes of the character that a text begins with; 0: it is none, or longer than it needs to be, a
/// surrogate, or beyond U+10FFFF. [RFC 3629]
std::size_t lengthOfFirst(std::string_view text) {
    const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(text[i]); };
    const std::uint8_t first = byte(0);
    if (first < 0x80) return 1;
    const std::size_t length = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
    if (first < 0xc2 || first > 0xf4 || text.size() < length) return 0;
    for (std::size_t i = 1; i < length; ++i)
        if ((byte(i) & 0xc0) != 0x80) return 0;
    const bool isWrong = (first == 0xe0 && byte(1) < 0xa0) || (first == 0xed && byte(1) > 0x9f) ||
                         (first == 0xf0 && byte(1) < 0x90) || (first == 0xf4 && byte(1) > 0x8f);
    return isWrong ? 0 : length;
}

}  // namespace

bool mendUtf8(std::string_view text, std::string& mended) {
    bool isWhole = true;
    for (std::size_t i = 0; i < text.size();) {
        const std::size_t length = lengthOfFirst(text.substr(i));
        if (length == 0 && isWhole) mended = text.substr(0, i);
        isWhole = isWhole && length > 0;
        if (!isWhole) mended += length > 0 ? text.substr(i, length) : "\xef\xbf\xbd";
        i += length > 0 ? length : 1;
    }
    return !isWhole;
}

}  // namespace shadowcache
