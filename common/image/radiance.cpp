#include "common/image/radiance.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <memory>
#include <string>
#include <string_view>

#ifndef __clang_analyzer__  // which finds what is not ours to mend
#define STB_IMAGE_IMPLEMENTATION
#endif
#define STB_IMAGE_STATIC
#define STBI_ONLY_HDR
#define STBI_NO_STDIO
#include <stb/stb_image.h>

#include "common/base/error.h"
#include "common/base/file_bytes.h"
#include "common/image/exr_radiance.h"

namespace shadowcache {

namespace {

constexpr std::string_view kExrMagic = "\x76\x2f\x31\x01";

struct HdrHeader {
    std::size_t width = 0;
    std::size_t height = 0;
    std::size_t bytes = 0;
    float exposure = 1.0f;  ///< texels are to be divided by it
};

/// Header lines up to an empty one, then "-Y HEIGHT +X WIDTH".
HdrHeader parseHdrHeader(const std::filesystem::path& path, const std::string& content) {
    static constexpr std::string_view kFormat = "FORMAT=32-bit_rle_rgbe";
    HdrHeader header;
    if (!content.starts_with("#?RADIANCE\n") && !content.starts_with("#?RGBE\n"))
        throwFileError(path, "starts with '" +
                                 content.substr(0, std::min<std::size_t>(content.find('\n'), 20)) +
                                 "', expected #?RADIANCE or #?RGBE");
    TextScanner text(path, content, false);
    for (bool hasFormat = false;;) {
        if (!text.nextLine()) throwFileError(path, "truncated: ends within the HDR header");
        const std::string_view word = text.wordOnLine();
        if (word.empty()) {
            if (!hasFormat) text.fail("no FORMAT before, expected " + std::string(kFormat));
            break;
        }
        if (word == kFormat)
            hasFormat = true;
        else if (word.starts_with("FORMAT"))
            text.fail("'" + std::string(word.substr(0, 30)) + "', expected " +
                      std::string(kFormat));
        if (word.starts_with("EXPOSURE=")) {
            const std::string_view value = word.substr(9);
            header.exposure *=
                static_cast<float>(text.number(value.empty() ? text.wordOnLine() : value));
            if (!(header.exposure > 0.0f && std::isfinite(header.exposure)))
                text.fail("EXPOSURE of " + std::to_string(header.exposure) +
                          " with those before it, expected above 0 and finite");
        }
    }
    text.nextLine();
    const auto side = [&](std::string_view axis) {
        const std::string_view found = text.wordOnLine();
        if (found != axis) {
            text.fail("resolution axis '" + std::string(found.substr(0, 20)) + "', expected '" +
                      std::string(axis) + "'");
        }
        const long long size = text.integer(text.wordOnLine());
        if (size < 1 || size > (1 << 24)) {
            text.fail("side of " + std::to_string(size) + " pixels, expected 1 to 16777216");
        }
        return static_cast<std::size_t>(size);
    };
    header.height = side("-Y");
    header.width = side("+X");
    if (!text.nextLine()) throwFileError(path, "truncated: ends after the HDR header");
    header.bytes = content.size() - text.bytesLeft();
    return header;
}

/// Bytes of one run-length coded row at the start of `data`; 0 if it is cut off or damaged.
std::size_t codedRowBytes(std::string_view data, std::size_t width) {
    std::size_t at = 4;
    for (int channel = 0; channel < 4; ++channel) {
        for (std::size_t x = 0; x < width;) {
            if (at >= data.size()) return 0;
            const auto code = static_cast<unsigned char>(data[at]);
            const std::size_t length = code > 128 ? code - 128u : code;
            at += code > 128 ? 2 : 1 + length;
            x += length;
            if (length == 0 || x > width) return 0;
        }
    }
    return at <= data.size() ? at : 0;
}

/// stb reads what is missing as zeros, so every row is looked for before it is called.
void requireAllHdrRows(const std::filesystem::path& path, const HdrHeader& header,
                       std::string_view data) {
    constexpr std::size_t kLeastCodedWidth = 8;
    constexpr std::size_t kMostCodedWidth = 32767;
    const bool coded = header.width >= kLeastCodedWidth && header.width <= kMostCodedWidth &&
                       data.size() >= 4 && data[0] == 2 && data[1] == 2 && (data[2] & 0x80) == 0;
    if (!coded) {
        const double wanted =
            4.0 * static_cast<double>(header.width) * static_cast<double>(header.height);
        if (wanted > static_cast<double>(data.size())) {
            throwFileError(path, "truncated: " + std::to_string(data.size()) +
                                     " bytes of texels, expected " +
                                     std::to_string(static_cast<long long>(wanted)));
        }
        return;
    }
    for (std::size_t y = 0; y < header.height; ++y) {
        const bool marked = data.size() >= 4 && data[0] == 2 && data[1] == 2 &&
                            (static_cast<unsigned char>(data[2]) * 256u +
                             static_cast<unsigned char>(data[3])) == header.width;
        const std::size_t bytes = marked ? codedRowBytes(data, header.width) : 0;
        if (bytes == 0) {
            throwFileError(path, "truncated or damaged: row " + std::to_string(y) + " of " +
                                     std::to_string(header.height) + " is not whole");
        }
        data.remove_prefix(bytes);
    }
}

Image readHdr(const std::filesystem::path& path) {
    std::string content = readFileBytes(path);
    const HdrHeader header = parseHdrHeader(path, content);
    requireAllHdrRows(path, header, std::string_view(content).substr(header.bytes));
    // stb meets a plain header: of one with two resolutions it might take the other.
    content.replace(0, header.bytes,
                    "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y " + std::to_string(header.height) +
                        " +X " + std::to_string(header.width) + "\n");
    if (content.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
        throwFileError(path, "larger than 2 GB, expected a smaller HDR file");
    }
    int width = 0;
    int height = 0;
    int channels = 0;
    const std::unique_ptr<float, decltype(&std::free)> texels(
        stbi_loadf_from_memory(reinterpret_cast<const stbi_uc*>(content.data()),
                               static_cast<int>(content.size()), &width, &height, &channels, 3),
        &std::free);
    if (!texels)
        throwFileError(path, std::string("is not a Radiance HDR file: ") + stbi_failure_reason());
    Image image{width, height, {}};
    image.pixels.resize(header.width * header.height);
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        const float* t = texels.get() + 3 * i;
        image.pixels[i] = Rgb(t[0], t[1], t[2]) / header.exposure;
    }
    return image;
}

/// Makes every texel usable as radiance and counts what was not.
void mend(RadianceImage& result) {
    for (Rgb& pixel : result.image.pixels) {
        if (!std::isfinite(pixel.x) || !std::isfinite(pixel.y) || !std::isfinite(pixel.z)) {
            pixel = Rgb(0.0f);
            ++result.notFinite;
        } else if (pixel.x < 0.0f || pixel.y < 0.0f || pixel.z < 0.0f) {
            pixel = Rgb(std::max(pixel.x, 0.0f), std::max(pixel.y, 0.0f), std::max(pixel.z, 0.0f));
            ++result.negative;
        }
    }
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
