#pragma once

#include "common/image/image.h"

namespace shadowcache::bench {

/// Mean over pixels and renders of how much brighter an image is than a reference, as a share.
struct Deviation {
    double sum = 0, squares = 0, count = 0;

    /// @param scale  of the reference; other than 1 for a control
    void add(const Image& image, const Image& reference, double scale);
    double mean() const { return sum / count; }
    /// In standard errors.
    double significance() const;
};

}  // namespace shadowcache::bench
