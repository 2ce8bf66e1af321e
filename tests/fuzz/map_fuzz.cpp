// Environment maps: OpenEXR and Radiance HDR.

#include <cmath>

#include "common/image/radiance.h"
#include "tests/fuzz/input_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    using namespace shadowcache;
    static fuzz::InputFile file(std::string("in") + SHADOWCACHE_EXTENSION);
    fuzz::readAs(file, {bytes, size}, [](const std::filesystem::path& path) {
        const RadianceImage map = readRadiance(path);
        for (const Rgb& texel : map.image.pixels)
            for (int k = 0; k < 3; ++k) fuzz::require(texel[k] >= 0 && std::isfinite(texel[k]));
    });
    return 0;
}
