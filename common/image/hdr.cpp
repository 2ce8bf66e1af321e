#include "common/image/hdr.h"

#include <fmt/core.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/error.h"
#include "common/base/file_bytes.h"
#include "common/base/interrupt.h"
#include "common/base/progress.h"
#include "common/image/hdr_header.h"
#include "common/image/primaries.h"
#include "common/image/size_limits.h"

namespace shadowcache {

namespace {

/// Scan lines of these lengths may be in runs by channel; others are not.
constexpr std::size_t kLeastCoded = 8;
constexpr std::size_t kMostCoded = 32767;
constexpr std::size_t kLongestRun = 128;

using Rgbe = std::array<std::uint8_t, 4>;

/// Scan lines one after the other. Each of them may be coded in another way.
class ScanLines {
public:
    explicit ScanLines(std::string_view data) : data_(data) {}

    /// @return false if the data end, or are damaged
    bool read(std::vector<Rgbe>& line) {
        const bool coded = line.size() >= kLeastCoded && line.size() <= kMostCoded && left() >= 4 &&
                           byteAt(0) == 2 && byteAt(1) == 2 && byteAt(2) < 128;
        return coded ? readRunsByChannel(line) : readPixels(line);
    }

private:
    std::size_t left() const { return data_.size() - at_; }
    std::uint8_t byteAt(std::size_t i) const { return static_cast<std::uint8_t>(data_[at_ + i]); }

    bool readRunsByChannel(std::vector<Rgbe>& line) {
        if (byteAt(2) * std::size_t{256} + byteAt(3) != line.size()) return false;
        at_ += 4;
        for (std::size_t channel = 0; channel < 4; ++channel)
            for (std::size_t x = 0; x < line.size();) {
                if (left() < 2) return false;
                const std::size_t code = byteAt(0);
                const bool run = code > kLongestRun;
                const std::size_t length = run ? code - kLongestRun : code;
                const std::size_t bytes = run ? 2 : 1 + length;
                if (length == 0 || length > line.size() - x || bytes > left()) return false;
                for (std::size_t i = 0; i < length; ++i)
                    line[x + i][channel] = byteAt(run ? 1 : 1 + i);
                at_ += bytes;
                x += length;
            }
        return true;
    }

    /// Pixels as they are. 1 1 1 N repeats the one before N times; of several such in a row each
    /// counts 256 times as much as the one before it.
    bool readPixels(std::vector<Rgbe>& line) {
        std::size_t shift = 0;
        for (std::size_t x = 0; x < line.size();) {
            if (left() < 4) return false;
            const Rgbe pixel{byteAt(0), byteAt(1), byteAt(2), byteAt(3)};
            at_ += 4;
            if (pixel[0] != 1 || pixel[1] != 1 || pixel[2] != 1) {
                line[x++] = pixel;
                shift = 0;
                continue;
            }
            if (shift > 24) return false;
            const std::size_t length = std::size_t{pixel[3]} << shift;
            if (x == 0 || length > line.size() - x) return false;
            for (std::size_t i = 0; i < length; ++i) line[x + i] = line[x - 1];
            x += length;
            shift += 8;
        }
        return true;
    }

    std::string_view data_;
    std::size_t at_ = 0;
};

/// Texels of RGBE numbers. An exponent of 0 is black.
class Decoder {
public:
    explicit Decoder(const HdrHeader& header) {
        for (int exponent = 1; exponent < 256; ++exponent)
            for (std::size_t k = 0; k < 3; ++k)
                scale_[static_cast<std::size_t>(exponent)][k] =
                    std::ldexp(1.0, exponent - 136) / header.multiplier[k];
    }

    Rgb operator()(const Rgbe& pixel) const {
        const auto& scale = scale_[pixel[3]];
        return {static_cast<float>(pixel[0] * scale[0]), static_cast<float>(pixel[1] * scale[1]),
                static_cast<float>(pixel[2] * scale[2])};
    }

private:
    std::array<std::array<double, 3>, 256> scale_{};
};

}  // namespace

RadianceImage readHdr(const std::filesystem::path& path) {
    const std::string content = readFileBytes(path);
    const HdrHeader header = parseHdrHeader(path, content);
    if (!mayHoldValues(content.size(), 3.0 * static_cast<double>(header.width) *
                                           static_cast<double>(header.height)))
        throwFileError(path,
                       fmt::format("{} x {} pixels in a file of {} bytes, damaged or too large",
                                   header.width, header.height, content.size()));
    RadianceImage result;
    if (header.primaries) setPrimaries(path, *header.primaries, result);
    if (header.gamma.value_or(1) != 1)
        result.notes.push_back(
            fmt::format("GAMMA of {:g} is left out: texels are linear", *header.gamma));
    Image& image = result.image;
    image.width = static_cast<int>(header.width);
    image.height = static_cast<int>(header.height);
    image.pixels.resize(header.width * header.height);
    const std::size_t lines = header.byColumns ? header.width : header.height;
    std::vector<Rgbe> line(header.byColumns ? header.height : header.width);
    ScanLines scanLines(std::string_view(content).substr(header.bytes));
    const Decoder decode(header);
    Progress progress("read", lines);
    for (std::size_t i = 0; i < lines; ++i) {
        throwIfInterrupted();
        if (!scanLines.read(line))
            throwFileError(
                path,
                fmt::format("truncated or damaged: scan line {} of {} is not whole", i, lines));
        for (std::size_t k = 0; k < line.size(); ++k) {
            const std::size_t across = header.byColumns ? i : k, down = header.byColumns ? k : i;
            const std::size_t x = header.fromRight ? header.width - 1 - across : across;
            const std::size_t y = header.fromBottom ? header.height - 1 - down : down;
            image.pixels[y * header.width + x] = decode(line[k]);
        }
        progress.add(1);
    }
    return result;
}

}  // namespace shadowcache
