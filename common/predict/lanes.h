#pragma once

#include "common/cache/cache_header.h"

namespace shadowcache {

static_assert(kBlockCells == 16);

/// Folds sixteen numbers into one in a fixed order that suits SIMD registers.
template <class Fold>
float foldLanes(const float* x, Fold fold) {
    float half[8], quarter[4];
    for (int i = 0; i < 8; ++i) half[i] = fold(x[i], x[i + 8]);
    for (int i = 0; i < 4; ++i) quarter[i] = fold(half[i], half[i + 4]);
    return fold(fold(quarter[0], quarter[2]), fold(quarter[1], quarter[3]));
}

/// Sum of sixteen numbers.
inline float sumOf(const float* x) {
    return foldLanes(x, [](float a, float b) { return a + b; });
}

/// Maximum of sixteen numbers.
inline float maximumOf(const float* x) {
    return foldLanes(x, [](float a, float b) { return a > b ? a : b; });
}

/// Minimum of sixteen numbers.
inline float minimumOf(const float* x) {
    return foldLanes(x, [](float a, float b) { return a < b ? a : b; });
}

}  // namespace shadowcache
