// Camera files, to the rays that are traced.

#include <cmath>

#include "common/math/limits.h"
#include "common/shot/camera_file.h"
#include "common/shot/camera_rays.h"
#include "tests/fuzz/input_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    using namespace shadowcache;
    static fuzz::InputFile file("in.json");
    fuzz::readAs(file, {bytes, size}, [](const std::filesystem::path& path) {
        const CameraTrack track = readCameraFile(path);
        for (const Camera& camera : track.frames) {
            const CameraRays rays(camera, 1.5);
            for (const CameraRay& ray :
                 {rays.through({0, 1}), rays.through({0, 1}, {0.9, 0.2, 0})}) {
                fuzz::require(isInReach(ray.start / 10));
                fuzz::require(std::abs(ray.direction.length() - 1) < 1e-6);
                fuzz::require(!std::isnan(ray.reach));
            }
        }
    });
    return 0;
}
