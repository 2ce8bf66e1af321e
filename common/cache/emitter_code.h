#pragma once

#include <cstdint>

namespace shadowcache {

/// Most emitters whose visibility a cache may count.
inline constexpr int kMostEmittersOfCache = 32;

/// Rays of an item to an emitter, as a cache keeps them: 16 bits.
struct EmitterCode {
    /// @param rays  0 to 255, `visible` of them reached it
    static std::uint16_t of(int visible, int rays) {
        return static_cast<std::uint16_t>(visible | rays << 8);
    }
    static int visible(std::uint16_t code) { return code & 0xff; }
    static int rays(std::uint16_t code) { return code >> 8; }
    static bool isValid(std::uint16_t code) { return visible(code) <= rays(code); }
};

}  // namespace shadowcache
