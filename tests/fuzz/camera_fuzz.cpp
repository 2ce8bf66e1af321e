// Camera files, to the rays that are traced.

#include <cmath>

#include "common/math/limits.h"
#include "common/shot/camera.h"
#include "tests/fuzz/input_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    using namespace shadowcache;
    static fuzz::InputFile file("in.json");
    fuzz::readAs(file, {bytes, size}, [](const std::filesystem::path& path) {
        const CameraTrack track = readCameraFile(path);
        for (const Camera& camera : track.frames) {
            const CameraRays rays(camera, 1.5);
            fuzz::require(isInReach(rays.start({0, 1})));
            fuzz::require(std::abs(rays.direction({0, 1}).length() - 1) < 1e-6);
        }
    });
    return 0;
}
