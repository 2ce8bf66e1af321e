#include "common/image/radiance.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <string>
#include <string_view>

#include "common/base/error.h"
#include "common/base/file_bytes.h"
#include "common/base/number_text.h"
#include "common/image/exr_radiance.h"
#include "common/image/hdr.h"

namespace shadowcache {

namespace {

constexpr std::string_view kExrMagic = "\x76\x2f\x31\x01";

constexpr float kGreatestHalf = 65504.0f;

/// What +Inf stands for: a sun too bright for the numbers of its file, so the greatest of a half,
/// or of the file's own where they go higher.
float brightest(const Image& image) {
    float greatest = kGreatestHalf;
    for (const Rgb& pixel : image.pixels)
        for (int k = 0; k < 3; ++k)
            if (std::isfinite(pixel[k])) greatest = std::max(greatest, pixel[k]);
    return greatest;
}

/// Makes every texel usable as radiance and counts what was not.
void mend(RadianceImage& result) {
    const float infinity = brightest(result.image);
    for (Rgb& pixel : result.image.pixels) {
        if (std::isnan(pixel.x) || std::isnan(pixel.y) || std::isnan(pixel.z)) {
            pixel = Rgb(0.0f);
            ++result.notANumber;
            continue;
        }
        bool negative = false, infinite = false;
        for (int k = 0; k < 3; ++k) {
            negative = negative || pixel[k] < 0.0f;
            infinite = infinite || pixel[k] > std::numeric_limits<float>::max();
            pixel[k] = std::clamp(pixel[k], 0.0f, infinity);
        }
        result.negative += negative ? 1 : 0;
        result.infinite += infinite ? 1 : 0;
    }
    if (result.notANumber + result.negative > 0)
        result.notes.push_back(fmt::format("{} texels not a number and {} negative, set to 0",
                                           result.notANumber, result.negative));
    if (result.infinite > 0)
        result.notes.push_back(fmt::format("{} texels of +Inf, set to {}", result.infinite,
                                           numberText(static_cast<double>(infinity))));
}

}  // namespace

RadianceImage readRadiance(const std::filesystem::path& path) {
    requireReadableFile(path);
    std::string magic(kExrMagic.size(), '\0');
    std::ifstream(path, std::ios::binary)
        .read(magic.data(), static_cast<std::streamsize>(magic.size()));

    RadianceImage result;
    if (magic == kExrMagic) {
        result = readExrRadiance(path);
    } else if (magic.starts_with("#?")) {
        result.image = readHdr(path);
    } else {
        throwFileError(path, "is neither OpenEXR nor Radiance HDR");
    }
    mend(result);
    return result;
}

}  // namespace shadowcache
