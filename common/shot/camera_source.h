#pragma once

#include <optional>
#include <span>
#include <string>

#include "common/shot/camera.h"
#include "common/shot/gltf_shot.h"

namespace shadowcache {

/// Which camera a shot is seen by.
struct CameraOptions {
    std::string name;  ///< a file, or one of the set's cameras; empty: the one that stands still
    std::optional<Vec3d> eye, lookAt;  ///< of the camera that stands still
    double fovYDegrees = 45;
    double shutter = 0;  ///< share of a frame's time that the shutter is open, 0 .. 1

    /// Whether `name` is a file's, whatever the set holds.
    bool isFile() const;
};

/// Cameras of a shot, by frame: of a camera file, of a glTF set, or the one that stands still.
class CameraSource {
public:
    /// @param shots  must live as long as this
    /// @throws Error if the camera cannot be read, or has no such name
    CameraSource(const CameraOptions& options, std::span<const GltfShot> shots);

    /// @throws Error if the camera has no such frame
    Camera at(int frame) const;

    /// What it does while the shutter is open: around the frame's time, half before and half after.
    ///
    /// @throws Error if the camera has no such frame, or as between() does
    CameraMove moveAt(int frame) const;

    /// What of the camera a picture does not show; empty: nothing.
    std::string note(int frame) const;

    /// Frames a second that its file states, or its glTF set is played at; 0: it stands still.
    double fps() const;

private:
    Camera atTime(double time) const;

    CameraOptions options_;
    std::optional<CameraTrack> track_;
    NamedCamera named_;
};

}  // namespace shadowcache
