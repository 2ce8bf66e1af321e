#include "common/shot/camera_source.h"

#include <fmt/core.h>

#include <filesystem>

#include "common/base/error.h"
#include "common/base/option_checks.h"
#include "common/shot/camera_file.h"

namespace shadowcache {

bool CameraOptions::isFile() const {
    return std::filesystem::path(name).extension() == ".json";
}

CameraSource::CameraSource(const CameraOptions& options, std::span<const GltfShot> shots)
    : options_(options) {
    requireRange("shutter", options.shutter, 0.0, 1.0);
    if (options.name.empty()) return;
    if (shots.empty() || options.isFile())
        track_ = readCameraFile(options.name);
    else
        named_ = findCamera(shots, options.name);
}

Camera CameraSource::at(int frame) const {
    if (track_) cameraAtFrame(*track_, frame);
    return atTime(frame);
}

CameraMove CameraSource::moveAt(int frame) const {
    const Camera middle = at(frame);
    const double half = options_.shutter / 2;
    if (half == 0) return middle;
    try {
        const CameraMove move(atTime(frame - half), atTime(frame + half));
        move.middle();
        return move;
    } catch (const Error& e) {
        throw Error(fmt::format("--shutter {:g}, frame {}: {}", options_.shutter, frame, e.what()));
    }
}

std::string CameraSource::note(int frame) const {
    return named_.shot ? named_.shot->cameraNote(named_.node, frame) : "";
}

double CameraSource::fps() const {
    if (track_) return track_->fps;
    return named_.shot ? named_.shot->fps() : 0;
}

Camera CameraSource::atTime(double time) const {
    if (track_) return cameraAtTime(*track_, time);
    if (named_.shot) return named_.shot->camera(named_.node, time);
    // A plan has its north, -Z, at the top.
    const bool vertical =
        options_.eye->x == options_.lookAt->x && options_.eye->z == options_.lookAt->z;
    const Vec3d up = vertical ? Vec3d(0, 0, -1) : Vec3d(0, 1, 0);
    return lookAt(*options_.eye, *options_.lookAt, up, options_.fovYDegrees * kPi / 180);
}

}  // namespace shadowcache
