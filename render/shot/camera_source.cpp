#include "render/shot/camera_source.h"

namespace shadowcache {

CameraSource::CameraSource(const RenderJob& job, std::span<const GltfShot> shots) : job_(job) {
    if (job.camera.empty()) return;
    if (shots.empty() || std::filesystem::path(job.camera).extension() == ".json")
        track_ = readCameraFile(job.camera);
    else
        named_ = findCamera(shots, job.camera);
}

Camera CameraSource::at(int frame) const {
    if (track_) return cameraAtFrame(*track_, frame);
    if (named_.shot) return named_.shot->camera(named_.node, frame);
    // A plan has its north, -Z, at the top.
    const bool vertical = job_.eye->x == job_.lookAt->x && job_.eye->z == job_.lookAt->z;
    const Vec3d up = vertical ? Vec3d(0, 0, -1) : Vec3d(0, 1, 0);
    return lookAt(*job_.eye, *job_.lookAt, up, job_.fovYDegrees * kPi / 180);
}

}  // namespace shadowcache
