#include "common/image/radiance.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/base/error.h"
#include "common/base/file_bytes.h"
#include "common/base/interrupt.h"
#include "common/base/parallel.h"
#include "common/image/exr_radiance.h"
#include "common/image/hdr.h"

namespace shadowcache {

namespace {

constexpr std::string_view kExrMagic = "\x76\x2f\x31\x01";

constexpr float kGreatestHalf = 65504.0f;

/// The brightest that a texel may be, so that sums and squares of its light stay finite; that of
/// what emits is as great.
constexpr float kMostRadiance = 1e15f;

constexpr std::size_t kTexelsPerChunk = std::size_t{1} << 16;

/// A part of `texels` for each chunk of a parallel loop, which ends where it is asked to.
template <class Part, class Visit>
std::vector<Part> partsOf(std::span<Rgb> texels, const Visit& visit) {
    std::vector<Part> parts(texels.size() / kTexelsPerChunk + 1);
    parallelFor(texels.size(), kTexelsPerChunk, [&](const Chunk& chunk) {
        throwIfInterrupted();
        for (Rgb& texel : texels.subspan(chunk.begin, chunk.end - chunk.begin))
            visit(texel, parts[chunk.index]);
    });
    return parts;
}

/// What +Inf stands for: a sun too bright for the numbers of its file, so the greatest of a half,
/// or of the file's own where they go higher.
float brightest(std::span<Rgb> texels) {
    const std::vector<float> greatest = partsOf<float>(texels, [](const Rgb& texel, float& most) {
        for (int k = 0; k < 3; ++k)
            if (std::isfinite(texel[k])) most = std::max(most, texel[k]);
    });
    return std::clamp(std::ranges::max(greatest), kGreatestHalf, kMostRadiance);
}

constexpr double kSeenShare = 1e-3;  // of a map's light that is told

/// Texels that were mended.
struct Mended {
    std::size_t notANumber = 0, negative = 0, infinite = 0, tooBright = 0;
    double light = 0, below = 0;  ///< sums of what stays, and of what was below 0
};

void mend(Rgb& texel, float infinity, Mended& mended) {
    if (std::isnan(texel.x) || std::isnan(texel.y) || std::isnan(texel.z)) {
        texel = Rgb(0.0f);
        ++mended.notANumber;
        return;
    }
    bool negative = false, infinite = false, tooBright = false;
    for (int k = 0; k < 3; ++k) {
        negative = negative || texel[k] < 0.0f;
        if (texel[k] < 0.0f) mended.below -= static_cast<double>(std::max(texel[k], -infinity));
        infinite = infinite || texel[k] > std::numeric_limits<float>::max();
        tooBright = tooBright || texel[k] > kMostRadiance;
        texel[k] = std::clamp(texel[k], 0.0f, infinity);
        mended.light += static_cast<double>(texel[k]);
    }
    mended.negative += negative ? 1 : 0;
    mended.infinite += infinite ? 1 : 0;
    mended.tooBright += tooBright && !infinite ? 1 : 0;
}

/// How much of the light was below 0; empty where that cannot be seen.
std::string shareText(double below, double all) {
    return below > kSeenShare * all ? fmt::format(", {:.2g} % of the light", 100 * below / all)
                                    : "";
}

/// What a file is that begins with these bytes.
std::string kindOf(std::string_view magic) {
    constexpr std::pair<std::string_view, const char*> kKinds[] = {{"\x89PNG", "PNG"},
                                                                   {"\xff\xd8\xff", "JPEG"},
                                                                   {"II*", "TIFF"},
                                                                   {{"MM\0*", 4}, "TIFF"},
                                                                   {"PF", "PFM"},
                                                                   {"DDS ", "DDS"},
                                                                   {"RIFF", "RIFF (as WebP)"},
                                                                   {"BM", "BMP"}};
    for (const auto& [start, name] : kKinds)
        if (magic.starts_with(start)) return name;
    std::string text = "a file of the bytes";
    for (const char byte : magic) text += fmt::format(" {:02x}", static_cast<unsigned char>(byte));
    return text + " ...";
}

/// Makes every texel usable as radiance and counts what was not.
void mend(RadianceImage& result) {
    const std::span<Rgb> texels = result.image.pixels;
    const float infinity = brightest(texels);
    double light = 0, below = 0;
    std::size_t tooBright = 0;
    for (const Mended& part : partsOf<Mended>(
             texels, [&](Rgb&texel, Mended&mended) { mend(texel, infinity, mended); })) {
        result.notANumber += part.notANumber;
        result.negative += part.negative;
        result.infinite += part.infinite;
        tooBright += part.tooBright;
        light += part.light;
        below += part.below;
    }
    if (result.notANumber + result.negative > 0)
        result.notes.push_back(fmt::format("{} texels not a number and {} negative, set to 0{}",
                                           result.notANumber, result.negative,
                                           shareText(below, light + below)));
    if (result.infinite > 0)
        result.notes.push_back(fmt::format("{} texels of +Inf, set to {:.7g}", result.infinite,
                                           static_cast<double>(infinity)));
    if (tooBright > 0)
        result.notes.push_back(fmt::format("{} texels above {:g}, set to that", tooBright,
                                           static_cast<double>(kMostRadiance)));
}

}  // namespace

RadianceImage readRadiance(const std::filesystem::path& path) {
    requireReadableFile(path);
    std::string magic(kExrMagic.size(), '\0');
    std::ifstream in(path, std::ios::binary);
    in.read(magic.data(), static_cast<std::streamsize>(magic.size()));
    magic.resize(static_cast<std::size_t>(in.gcount()));

    RadianceImage result;
    if (magic == kExrMagic) {
        result = readExrRadiance(path);
    } else if (magic.starts_with("#?")) {
        result = readHdr(path);
    } else {
        throwFileError(path, "is neither OpenEXR nor Radiance HDR, but " + kindOf(magic));
    }
    mend(result);
    return result;
}

}  // namespace shadowcache
