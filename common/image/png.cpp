#include "common/image/png.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <new>
#include <vector>

namespace shadowcache {
namespace {

/// stb writes to what it is given, null or not.
void* allocated(void* block) {
    if (!block) throw std::bad_alloc();
    return block;
}

}  // namespace
}  // namespace shadowcache

#ifndef __clang_analyzer__  // which finds what is not ours to mend
#define STBIW_MALLOC(size) shadowcache::allocated(std::malloc(size))
#define STBIW_REALLOC(old, size) shadowcache::allocated(std::realloc(old, size))
#define STBIW_FREE(block) std::free(block)
#define STB_IMAGE_WRITE_IMPLEMENTATION
#endif
#define STB_IMAGE_WRITE_STATIC
#define STBI_WRITE_NO_STDIO
#include <stb/stb_image_write.h>

#include "common/base/atomic_file.h"
#include "common/base/error.h"
#include "common/image/srgb.h"

namespace shadowcache {

namespace {

unsigned char encode(float value, float gain) {
    const float linear = value * gain;
    if (!(linear > 0.0f)) return 0;  // NaN, too
    return static_cast<unsigned char>(std::lround(255.0f * linearToSrgb(std::min(linear, 1.0f))));
}

unsigned char opacity(float alpha) {
    return static_cast<unsigned char>(std::lround(255.0f * std::clamp(alpha, 0.0f, 1.0f)));
}

}  // namespace

std::string encodePng(const Image& image, float exposure, std::span<const float> alpha) {
    const float gain = std::exp2(exposure);
    const int channels = alpha.empty() ? 3 : 4;
    std::vector<unsigned char> bytes;
    bytes.reserve(image.pixels.size() * static_cast<std::size_t>(channels));
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        const Rgb& pixel = image.pixels[i];
        const float share = alpha.empty() ? 1 : alpha[i];
        for (const float value : {pixel.x, pixel.y, pixel.z})
            bytes.push_back(encode(value, share > 0 ? gain / share : 0));
        if (!alpha.empty()) bytes.push_back(opacity(share));
    }
    std::string png;
    const auto append = [](void* context, void* data, int size) {
        static_cast<std::string*>(context)->append(static_cast<const char*>(data),
                                                   static_cast<std::size_t>(size));
    };
    if (!stbi_write_png_to_func(append, &png, image.width, image.height, channels, bytes.data(),
                                image.width * channels)) {
        throw Error(fmt::format("a picture of {}x{} could not be encoded as PNG", image.width,
                                image.height));
    }
    return png;
}

void writePng(const std::filesystem::path& path, const Image& image, float exposure,
              std::span<const float> alpha) {
    writeWhole(path, encodePng(image, exposure, alpha));
}

}  // namespace shadowcache
