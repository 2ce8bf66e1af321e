#pragma once

#include <cstdint>

namespace shadowcache {

/// Most memory this process has held at once, in bytes.
std::uint64_t peakMemoryBytes();

/// Seconds since some fixed moment, for differences.
double secondsNow();

}  // namespace shadowcache
