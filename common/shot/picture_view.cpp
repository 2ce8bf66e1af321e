#include "common/shot/picture_view.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace shadowcache {

namespace {

/// A matrix of points as rows: its columns are linear functions of the place.
class Columns {
public:
    explicit Columns(const Vec3d& origin) : origin_(origin) { matrix_[15] = 1; }

    /// Column `k`: (place - origin) . `along` + `constant`.
    void set(std::size_t k, const Vec3d& along, double constant) {
        for (int row = 0; row < 3; ++row)
            matrix_[static_cast<std::size_t>(4 * row) + k] = static_cast<float>(along[row]);
        matrix_[12 + k] = static_cast<float>(constant - origin_.dot(along));
    }
    const PointMatrix& matrix() const { return matrix_; }

private:
    Vec3d origin_;
    PointMatrix matrix_{};
};

}  // namespace

ExrView viewOf(const Camera& camera, int width, int height) {
    const Vec3d right = camera.forward.cross(camera.up), &up = camera.up, &along = camera.forward;
    const bool perspective = !(camera.height > 0);
    // Of the screen window: at distance 1, or of the whole view.
    const double high = perspective ? 2 * std::tan(camera.fovY / 2) : camera.height;
    const double wide = high * width / height * camera.pixelAspect;

    Columns toCamera(camera.origin), toNdc(camera.origin);
    toCamera.set(0, right, 0);
    toCamera.set(1, up, 0);
    toCamera.set(2, along, 0);
    const double middleX = 0.5 - camera.shiftX, middleY = 0.5 + camera.shiftY;
    if (perspective) {
        // x / w and y / w are the place on the picture; z / w = 1 - near / distance.
        toNdc.set(0, right / wide + along * middleX, 0);
        toNdc.set(1, along * middleY - up / high, 0);
        toNdc.set(2, along, -(camera.near > 0 ? camera.near : 1));
        toNdc.set(3, along, 0);
    } else {
        toNdc.set(0, right / wide, middleX);
        toNdc.set(1, -up / high, middleY);
        toNdc.set(2, along, 0);
    }
    ExrView view{.pixelAspect = static_cast<float>(camera.pixelAspect),
                 .worldToCamera = toCamera.matrix(),
                 .worldToNdc = toNdc.matrix()};
    if (perspective) {
        view.screenCenter = {static_cast<float>(-camera.shiftX * wide),
                             static_cast<float>(camera.shiftY * high)};
        view.screenWidth = static_cast<float>(wide);
    }
    return view;
}

std::string aspectNote(const Camera& camera, int width, int height) {
    if (!(camera.aspect > 0)) return "";
    // Sizes in whole pixels have the ratio of no other.
    const double found = width * camera.pixelAspect, wanted = height * camera.aspect;
    if (std::abs(found - wanted) < 1 || std::abs(found - wanted) < camera.aspect) return "";
    return fmt::format(
        "made for pictures {:.4g} times as wide as high, the size of {}x{} has {:.4g}: the view is "
        "as high as the camera's, and {}",
        camera.aspect, width, height, found / height, found < wanted ? "narrower" : "wider");
}

double farthestOf(const Camera& camera, const Box3d& box) {
    const auto along = [&](int axis) {
        const double way = camera.forward[axis], at = camera.origin[axis];
        return std::max(way * (box.min[axis] - at), way * (box.max[axis] - at));
    };
    return along(0) + along(1) + along(2);
}

}  // namespace shadowcache
