#include "bake/inspect/section_view.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/image/false_color.h"

namespace shadowcache {

namespace {

constexpr int kNothing = std::numeric_limits<int>::min();

struct Bounds {
    Vec3i low{std::numeric_limits<int>::max()}, high{kNothing};
};

Bounds boundsOf(const std::vector<Vec3i>& voxels) {
    Bounds bounds;
    for (const Vec3i& voxel : voxels)
        for (int k = 0; k < 3; ++k) {
            bounds.low[k] = std::min(bounds.low[k], voxel[k]);
            bounds.high[k] = std::max(bounds.high[k], voxel[k]);
        }
    return bounds;
}

/// Axes of the world that run to the right and down, seen along an axis; -1: backwards.
struct View {
    int right, down;
    int rightSign, downSign;
};
constexpr View kViews[] = {{2, 1, -1, -1}, {0, 2, 1, 1}, {0, 1, 1, -1}};

int along(const Bounds& bounds, const Vec3i& voxel, int axis, int sign) {
    return sign > 0 ? voxel[axis] - bounds.low[axis] : bounds.high[axis] - voxel[axis];
}

}  // namespace

Image sectionView(const std::vector<Vec3i>& voxels, const std::vector<Vec3f>& values, int axis,
                  double share, int side) {
    if (voxels.empty()) return {1, 1, {Rgb(1.0f)}};
    const Bounds bounds = boundsOf(voxels);
    const View& view = kViews[axis];
    const int width = bounds.high[view.right] - bounds.low[view.right] + 1;
    const int height = bounds.high[view.down] - bounds.low[view.down] + 1;
    const int step = (std::max(width, height) + side - 1) / side;  // voxels a pixel
    Image image{(width + step - 1) / step, (height + step - 1) / step, {}};
    image.pixels.assign(
        static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height), Rgb(1.0f));
    std::vector<int> nearest(image.pixels.size(), kNothing);

    const int depth = bounds.high[axis] - bounds.low[axis];
    const int cut = bounds.low[axis] + static_cast<int>(std::lround(share * depth));
    for (std::size_t v = 0; v < voxels.size(); ++v) {
        const int x = along(bounds, voxels[v], view.right, view.rightSign) / step;
        const int y = along(bounds, voxels[v], view.down, view.downSign) / step;
        const auto pixel = static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                           static_cast<std::size_t>(x);
        const int place = voxels[v][axis];
        if (place > cut || place < nearest[pixel]) continue;
        nearest[pixel] = place;
        const float pale = 0.5f * static_cast<float>(cut - place) /
                           static_cast<float>(std::max(1, cut - bounds.low[axis]));
        image.pixels[pixel] = falseColor(static_cast<double>(values[v].x)) * (1 - pale) + Rgb(pale);
    }
    return image;
}

}  // namespace shadowcache
