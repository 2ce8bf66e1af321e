#include "common/shot/camera_source.h"

#include <filesystem>

namespace shadowcache {

bool CameraOptions::isFile() const {
    return std::filesystem::path(name).extension() == ".json";
}

CameraSource::CameraSource(const CameraOptions& options, std::span<const GltfShot> shots)
    : options_(options) {
    if (options.name.empty()) return;
    if (shots.empty() || options.isFile())
        track_ = readCameraFile(options.name);
    else
        named_ = findCamera(shots, options.name);
}

Camera CameraSource::at(int frame) const {
    if (track_) return cameraAtFrame(*track_, frame);
    if (named_.shot) return named_.shot->camera(named_.node, frame);
    // A plan has its north, -Z, at the top.
    const bool vertical =
        options_.eye->x == options_.lookAt->x && options_.eye->z == options_.lookAt->z;
    const Vec3d up = vertical ? Vec3d(0, 0, -1) : Vec3d(0, 1, 0);
    return lookAt(*options_.eye, *options_.lookAt, up, options_.fovYDegrees * kPi / 180);
}

}  // namespace shadowcache
