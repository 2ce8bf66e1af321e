#pragma once

#include <cstdint>

namespace shadowcache {

/// What an open cache takes of its memory budget.
struct MemoryUse {
    std::uint64_t budget = 0;     ///< bytes; 0: no budget was set, and all others are 0
    std::uint64_t held = 0;       ///< bytes now: pages, those being read, and the table of pages
    std::uint64_t peak = 0;       ///< most bytes ever held
    std::uint64_t loads = 0;      ///< pages read, the same page counted each time
    std::uint64_t drops = 0;      ///< pages dropped
    std::uint64_t bytesRead = 0;  ///< bytes of the file, packed as they are there
};

}  // namespace shadowcache
