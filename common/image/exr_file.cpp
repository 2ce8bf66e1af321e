#include "common/image/exr_file.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>

#include "common/base/error.h"
#include "common/base/file_bytes.h"
#include "common/base/interrupt.h"
#include "common/base/progress.h"
#include "common/image/exr_header.h"

namespace shadowcache {

namespace {

/// Keeps a hostile header from asking for all memory, as kMostExrPixels does.
constexpr int kMaxSide = 1 << 17;

constexpr int kNewestVersion = 2;

void requireKnownVersion(const std::filesystem::path& path) {
    requireReadableFile(path);
    std::array<char, 8> head{};
    std::ifstream(path, std::ios::binary).read(head.data(), head.size());
    if (head[0] != 0x76 || head[1] != 0x2f || head[2] != 0x31 || head[3] != 0x01) {
        throwFileError(path, "is not an OpenEXR file");
    }
    if (head[4] > kNewestVersion) {
        throwFileError(path, fmt::format("OpenEXR version {}, expected at most {}", int{head[4]},
                                         kNewestVersion));
    }
}

}  // namespace

Imf::MultiPartInputFile openExr(const std::filesystem::path& path) {
    requireKnownVersion(path);
    requireSoundExrHeader(path);
    Imf::Header::setMaxImageSize(kMaxSide, kMaxSide);
    Imf::Header::setMaxTileSize(kMaxSide, kMaxSide);
    return Imf::MultiPartInputFile(path.c_str());
}

Imath::Box2i checkedWindow(const std::filesystem::path& path, const Imf::MultiPartInputFile& file,
                           int part) {
    if (!file.partComplete(part)) throwFileError(path, "truncated: some of its pixels are missing");
    const Imath::Box2i window = file.header(part).dataWindow();
    const double width = static_cast<double>(window.max.x) - window.min.x + 1.0;
    const double height = static_cast<double>(window.max.y) - window.min.y + 1.0;
    if (width * height > kMostExrPixels) {
        throwFileError(path,
                       fmt::format("data window of {} x {} pixels, expected at most 2^29",
                                   static_cast<long long>(width), static_cast<long long>(height)));
    }
    return window;
}

bool isDeep(const Imf::Header& header) {
    return header.hasType() && Imf::isDeepData(header.type());
}

void requireFullResolution(const std::filesystem::path& path, const std::string& name,
                           const Imf::Channel& channel) {
    if (channel.xSampling != 1 || channel.ySampling != 1) {
        throwFileError(path, "channel " + name + " is subsampled, expected full resolution");
    }
}

void readChannels(Imf::MultiPartInputFile& file, int part, const std::vector<std::string>& names,
                  std::size_t valueStride,
                  const std::function<float*(const std::string&)>& target) {
    const Imath::Box2i window = file.header(part).dataWindow();
    const auto width = static_cast<std::size_t>(window.size().x) + 1;
    Imf::FrameBuffer frame;
    for (const std::string& name : names) {
        const Imf::Channel& channel = file.header(part).channels()[name];
        const std::size_t columns = width / static_cast<std::size_t>(channel.xSampling);
        frame.insert(name,
                     Imf::Slice::Make(Imf::FLOAT, target(name), window, valueStride,
                                      valueStride * columns, channel.xSampling, channel.ySampling));
    }
    Imf::InputPart input(file, part);
    input.setFrameBuffer(frame);
    // The lines of the largest blocks that are compressed as one.
    constexpr int kLines = 256;
    const int height = window.size().y + 1;
    Progress progress("read", static_cast<std::uint64_t>(height));
    for (int left = height; left > 0; left -= kLines) {
        throwIfInterrupted();
        const int first = window.max.y - (left - 1);
        input.readPixels(first, window.max.y - std::max(0, left - kLines));
        progress.add(static_cast<std::uint64_t>(std::min(left, kLines)));
    }
}

}  // namespace shadowcache
