#pragma once

#include <chrono>
#include <cstdint>
#include <utility>

namespace shadowcache {

/// Nanoseconds since this was made, or since the last call.
class Stopwatch {
public:
    std::uint64_t sinceLast() {
        const auto now = std::chrono::steady_clock::now();
        const auto passed = now - std::exchange(last_, now);
        return static_cast<std::uint64_t>(
            std::chrono::duration_cast<std::chrono::nanoseconds>(passed).count());
    }

private:
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace shadowcache
