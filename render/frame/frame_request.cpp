#include "render/frame/frame_request.h"

#include "common/base/hash.h"

namespace shadowcache {

std::uint64_t pixelSeed(std::uint64_t seed, int frame, int x, int y, int cameraRay) {
    const auto word = [](int high, int low) {
        return static_cast<std::uint64_t>(static_cast<std::uint32_t>(high)) << 32 |
               static_cast<std::uint32_t>(low);
    };
    return hashWords(seed, word(frame, cameraRay), word(y, x));
}

}  // namespace shadowcache
