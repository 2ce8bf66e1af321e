#pragma once

#include <cstdint>

namespace shadowcache {

/// What a memory budget came to.
struct MemoryUse {
    std::uint64_t budget = 0;  ///< bytes; 0: none was set
    std::uint64_t held = 0;    ///< bytes now: pages, those being read, and what says where they are
    std::uint64_t peak = 0;    ///< most bytes ever held
    std::uint64_t loads = 0;   ///< pages read, the same page counted each time
    std::uint64_t drops = 0;   ///< pages given up
    std::uint64_t bytesRead = 0;
};

}  // namespace shadowcache
