#include "common/import/texture_decoder.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <memory>

#ifndef __clang_analyzer__  // which finds what is not ours to mend
#define STB_IMAGE_IMPLEMENTATION
#endif
#define STB_IMAGE_STATIC
#define STBI_ONLY_JPEG
#define STBI_ONLY_PNG
#define STBI_NO_STDIO
#include <stb/stb_image.h>

#include "common/import/webp_decoder.h"

namespace shadowcache {

namespace {

/// Texels that a byte of a file stands for, at most: deflate makes 1032 bytes of one, each of eight
/// texels of one bit.
constexpr double kMostTexelsPerByte = 8256;
/// Small pictures may be as empty as they like: 16 MB, of 16 bits 32 MB.
constexpr double kTexelsAlways = 0x1p22;

constexpr std::string_view kPngSignature = "\x89PNG\r\n\x1a\n";

bool isPng(std::string_view bytes) {
    return bytes.starts_with(kPngSignature);
}

/// Whether a PNG's chunks end where their lengths say, up to the last: what is behind IEND is no
/// part of it. stb allocates such a length before it reads.
bool hasSoundChunks(std::string_view png) {
    if (!isPng(png)) return true;  // a JPEG, or what stb refuses
    png.remove_prefix(kPngSignature.size());
    constexpr std::size_t kHead = 8, kChecksum = 4;
    while (png.size() >= kHead) {
        std::size_t length = 0;
        for (std::size_t k = 0; k < 4; ++k)
            length = length << 8 | static_cast<unsigned char>(png[k]);
        if (length > png.size() - kHead) return false;
        if (png.substr(4, 4) == "IEND") return true;
        png.remove_prefix(std::min(png.size(), kHead + length + kChecksum));
    }
    return true;
}

/// Whether the Huffman tables of a JPEG's segment, from its length on, have at most 256 codes each:
/// stb writes beyond its array if not.
bool hasSoundTables(std::string_view segment) {
    const auto byte = [&](std::size_t i) -> std::size_t {
        return i < segment.size() ? static_cast<unsigned char>(segment[i]) : 0;  // as stb reads on
    };
    constexpr std::size_t kHead = 17;
    const std::size_t end = byte(0) * 256 + byte(1);
    for (std::size_t at = 2; at < end;) {
        std::size_t codes = 0;
        for (std::size_t k = 1; k < kHead; ++k) codes += byte(at + k);
        if (codes > 256) return false;
        at += kHead + codes;
    }
    return true;
}

/// The same of all that stb may take for tables in a JPEG: it looks for markers anywhere but within
/// other segments, which it passes over by their lengths, and behind the end, where phones put
/// films.
bool hasSoundHuffmanTables(std::string_view jpeg) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(jpeg[i]); };
    constexpr unsigned char kStuffing = 0, kTables = 0xc4, kStart = 0xd8, kEnd = 0xd9, kFill = 0xff;
    for (std::size_t i = 0; i + 1 < jpeg.size();) {
        const unsigned char marker = byte(i + 1);
        if (byte(i) != kFill || marker == kFill) {
            ++i;
            continue;
        }
        if (marker == kEnd) return true;
        i += 2;
        if (marker == kTables && !hasSoundTables(jpeg.substr(i))) return false;
        // Those of restarts have no length, as the start.
        const bool bare = marker == kStuffing || (marker >= 0xd0 && marker <= kStart);
        if (!bare && i + 1 < jpeg.size()) i += byte(i) * std::size_t{256} + byte(i + 1);
    }
    return true;
}

/// What stb has allocated.
template <class T>
using Texels = std::unique_ptr<T, decltype(&std::free)>;

}  // namespace

bool isPicture(std::string_view bytes) {
    return isPng(bytes) || bytes.starts_with("\xff\xd8") || isWebp(bytes);
}

Texture decodeTexture(std::string_view bytes, std::string& cause) {
    Texture texture;
    if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
        cause = "larger than 2 GB";
        return texture;
    }
    const double mostTexels =
        std::max(kTexelsAlways, kMostTexelsPerByte * static_cast<double>(bytes.size()));
    if (isWebp(bytes)) return decodeWebp(bytes, mostTexels, cause);
    if (!hasSoundChunks(bytes) || (!isPng(bytes) && !hasSoundHuffmanTables(bytes))) {
        cause = "cut short or damaged";
        return texture;
    }
    const auto* data = reinterpret_cast<const stbi_uc*>(bytes.data());
    const auto size = static_cast<int>(bytes.size());
    int channels = 0;
    // stb allocates what the header states.
    if (stbi_info_from_memory(data, size, &texture.width, &texture.height, &channels) != 0) {
        const double texels =
            static_cast<double>(texture.width) * static_cast<double>(texture.height);
        if (texels > mostTexels) {
            cause = fmt::format("{} x {} pixels in {} bytes", texture.width, texture.height, size);
            return {};
        }
    }
    const bool has16 = stbi_is_16_bit_from_memory(data, size) != 0;
    const Texels<stbi_us> wide(
        has16 ? stbi_load_16_from_memory(data, size, &texture.width, &texture.height, &channels, 4)
              : nullptr,
        &std::free);
    const Texels<stbi_uc> narrow(
        has16 ? nullptr
              : stbi_load_from_memory(data, size, &texture.width, &texture.height, &channels, 4),
        &std::free);
    if (!wide && !narrow) {
        const char* reason = stbi_failure_reason();
        cause = reason && *reason ? reason : "damaged";
        return {};
    }
    const std::size_t count =
        4 * static_cast<std::size_t>(texture.width) * static_cast<std::size_t>(texture.height);
    if (narrow) {
        texture.rgba.assign(narrow.get(), narrow.get() + count);
        return texture;
    }
    texture.rgba.reserve(count);
    texture.low.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
        texture.rgba.push_back(static_cast<std::uint8_t>(wide.get()[i] >> 8));
        texture.low.push_back(static_cast<std::uint8_t>(wide.get()[i] & 0xff));
    }
    return texture;
}

}  // namespace shadowcache
