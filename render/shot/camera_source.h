#pragma once

#include <optional>
#include <span>

#include "render/app/job.h"
#include "render/frame/camera.h"
#include "render/shot/gltf_shot.h"

namespace shadowcache {

/// Cameras of a job, by frame: of a camera file, of a glTF set, or the one that stands still.
class CameraSource {
public:
    /// @param job, shots  must live as long as this
    /// @throws Error if the camera cannot be read, or has no such name
    CameraSource(const RenderJob& job, std::span<const GltfShot> shots);

    /// @throws Error if the camera has no such frame
    Camera at(int frame) const;

private:
    const RenderJob& job_;
    std::optional<CameraTrack> track_;
    NamedCamera named_;
};

}  // namespace shadowcache
