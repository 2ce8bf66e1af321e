#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

namespace shadowcache {

// How the parts of a whole divide its light among them, in 2^32 steps. Every lit part owns at least
// one, and its chance is that of the steps it owns, so none is lost beside a sun.

/// Where dark parts at the end begin: past every step that is drawn.
inline constexpr std::uint32_t kNoStep = 0xffffffffu;

/// Steps in all, as a number.
inline constexpr double kSteps = 0x1p32;

/// Divides the steps. Dark parts own none: they begin where the next lit one does, those after the
/// last lit one at kNoStep.
///
/// @param light  of each part, at least 0
/// @param total  their sum
/// @param begin  receives the first step of each part
inline void divideSteps(std::span<const double> light, double total, std::uint32_t* begin) {
    const auto lit =
        static_cast<double>(std::ranges::count_if(light, [](double x) { return x > 0; }));
    const double scale = total > 0 ? (4294967294.0 - lit) * (1 - 1e-12) / total : 0;
    std::uint64_t sum = 0;
    std::size_t end = 0;  // after the last lit part
    for (std::size_t i = 0; i < light.size(); ++i) {
        begin[i] = static_cast<std::uint32_t>(sum);
        if (!(light[i] > 0)) continue;
        // By way of signed numbers, for which processors have an instruction.
        sum += 1 + static_cast<std::uint64_t>(static_cast<std::int64_t>(scale * light[i]));
        end = i + 1;
    }
    for (std::size_t i = end; i < light.size(); ++i) begin[i] = kNoStep;
}

/// Steps of the part at `part` of a whole that ends before `end`.
inline double stepsOf(const std::uint32_t* begin, std::size_t part, std::size_t end) {
    const std::uint32_t next = part + 1 < end ? begin[part + 1] : kNoStep;
    return (next == kNoStep ? kSteps : static_cast<double>(next)) -
           static_cast<double>(begin[part]);
}

/// Number of the last of `count` (>= 1) ascending values that is at most x; 0 if none is. Without
/// branches, which no processor could foresee.
template <class T>
std::uint32_t lastAtMost(const T* values, std::uint32_t count, T x) {
    std::uint32_t found = 0;
    for (std::uint32_t left = count; left > 1;) {
        const std::uint32_t half = left / 2;
        found += half * static_cast<std::uint32_t>(values[found + half] <= x);
        left -= half;
    }
    return found;
}

}  // namespace shadowcache
