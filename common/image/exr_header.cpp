#include "common/image/exr_header.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include "common/base/error.h"
#include "common/image/size_limits.h"

namespace shadowcache {

namespace {

// [OpenEXR file layout, https://openexr.com/en/latest/OpenEXRFileLayout.html]
constexpr std::uint32_t kMultiPart = 0x1000;
constexpr std::size_t kLongestName = 255;

/// Rows of a chunk, at most: those of DWAB.
constexpr std::uint64_t kMostRows = 256;

/// What a part of the file states of its size.
struct Part {
    std::array<std::int32_t, 4> window{0, 0, 0, 0};  ///< least x and y, greatest x and y
    std::optional<std::array<std::uint32_t, 2>> tile;
    std::uint64_t channels = 0;
};

class HeaderWalk {
public:
    explicit HeaderWalk(const std::filesystem::path& path)
        : path_(path), in_(path, std::ios::binary), size_(std::filesystem::file_size(path)) {}

    void run() {
        number();  // the magic number, which is checked before
        const bool several = (number() & kMultiPart) != 0;
        do {
            Part part;
            if (!readPart(part)) return;  // the empty header behind the last of several
            check(part);
        } while (several);
    }

private:
    [[noreturn]] void damaged() const { throwFileError(path_, "truncated or damaged header"); }

    std::uint32_t number() {
        std::uint32_t value = 0;
        if (!in_.read(reinterpret_cast<char*>(&value), sizeof value)) damaged();
        return value;
    }

    std::string name() {
        std::string text;
        for (int c = in_.get(); c != 0; c = in_.get()) {
            if (c < 0 || text.size() == kLongestName) damaged();
            text += static_cast<char>(c);
        }
        return text;
    }

    /// @return false if there is no attribute
    bool readPart(Part& part) {
        bool any = false;
        for (std::string attribute = name(); !attribute.empty(); attribute = name()) {
            any = true;
            const std::string type = name();
            const std::uint64_t length = number();
            const auto begin = static_cast<std::uint64_t>(in_.tellg());
            if (length > size_ - std::min(begin, size_))
                throwFileError(
                    path_,
                    fmt::format("truncated or damaged: attribute '{}' of {} bytes in a file of {}",
                                attribute.substr(0, 40), length, size_));
            if (!isOfLength(type, length))
                throwFileError(path_,
                               fmt::format("damaged: attribute '{}' of type {} with {} bytes",
                                           attribute.substr(0, 40), type.substr(0, 20), length));
            in_.seekg(static_cast<std::streamoff>(begin));
            if (attribute == "dataWindow" && length == sizeof part.window)
                in_.read(reinterpret_cast<char*>(part.window.data()), sizeof part.window);
            if (attribute == "tiles" && length >= 8) part.tile = {number(), number()};
            if (attribute == "channels" && type == "chlist") part.channels = channels_;
            in_.seekg(static_cast<std::streamoff>(begin + length));
        }
        return any;
    }

    /// Whether OpenEXR, which mostly goes by the type, reads just these bytes.
    bool isOfLength(const std::string& type, std::uint64_t length) {
        static const std::map<std::string, std::uint64_t, std::less<>> kFixed{
            {"box2f", 16},
            {"box2i", 16},
            {"chromaticities", 32},
            {"compression", 1},
            {"deepImageState", 1},
            {"double", 8},
            {"envmap", 1},
            {"float", 4},
            {"int", 4},
            {"keycode", 28},
            {"lineOrder", 1},
            {"m33d", 72},
            {"m33f", 36},
            {"m44d", 128},
            {"m44f", 64},
            {"rational", 8},
            {"tiledesc", 9},
            {"timecode", 8},
            {"v2d", 16},
            {"v2f", 8},
            {"v2i", 8},
            {"v3d", 24},
            {"v3f", 12},
            {"v3i", 12}};
        if (const auto fixed = kFixed.find(type); fixed != kFixed.end())
            return fixed->second == length;
        const auto begin = static_cast<std::uint64_t>(in_.tellg());
        if (type == "preview") {
            const std::uint64_t width = number(), height = number();
            return width <= length && height <= length && 8 + 4 * width * height == length;
        }
        if (type != "chlist") return true;  // read by its length
        constexpr std::streamoff kChannel = 16;
        for (channels_ = 0; !name().empty(); ++channels_) in_.seekg(kChannel, std::ios::cur);
        return static_cast<std::uint64_t>(in_.tellg()) == begin + length;
    }

    void check(const Part& part) const {
        const auto side = [&](std::size_t axis) {
            const std::int64_t pixels = std::int64_t{part.window[axis + 2]} - part.window[axis] + 1;
            return pixels > 0 ? static_cast<std::uint64_t>(pixels) : 0;
        };
        const std::uint64_t width = side(0), height = side(1);
        const auto over = [](std::uint64_t all, std::uint32_t one) {
            return (all + std::max(one, 1u) - 1) / std::max(one, 1u);
        };
        // Each chunk has a place of eight bytes in the table of offsets.
        const std::uint64_t chunks =
            part.tile ? over(width, (*part.tile)[0]) * over(height, (*part.tile)[1])
                      : height / kMostRows;
        const double values = static_cast<double>(width) * static_cast<double>(height) *
                              static_cast<double>(std::max<std::uint64_t>(part.channels, 1));
        if (chunks <= size_ / 8 && mayHoldValues(size_, values)) return;
        throwFileError(
            path_,
            fmt::format("data window of {} x {} pixels in a file of {} bytes, damaged or too large",
                        width, height, size_));
    }

    const std::filesystem::path& path_;
    std::ifstream in_;
    std::uint64_t size_;
    std::uint64_t channels_ = 0;  ///< of the last list of channels
};

}  // namespace

void requireSoundExrHeader(const std::filesystem::path& path) {
    HeaderWalk(path).run();
}

}  // namespace shadowcache
