#include "common/image/exr.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfChromaticitiesAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfRgbaYca.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>

#include "common/base/error.h"
#include "common/base/file_bytes.h"
#include "common/image/exr_error.h"
#include "common/image/exr_header.h"
#include "common/image/exr_radiance.h"
#include "common/image/image.h"

namespace shadowcache {

namespace {

/// Bounds that keep a hostile header from asking for all memory.
constexpr int kMaxSide = 1 << 17;
constexpr double kMaxPixels = 0x1p29;

constexpr int kNewestVersion = 2;

/// Least weight of a primary in the luminance (wide gamuts give a negative one): a texel with light
/// must never count as black, or it would never be sampled.
constexpr float kLeastLuminanceWeight = 0.01f;

void requireKnownVersion(const std::filesystem::path& path) {
    requireReadableFile(path);
    std::array<char, 8> head{};
    std::ifstream(path, std::ios::binary).read(head.data(), head.size());
    if (head[0] != 0x76 || head[1] != 0x2f || head[2] != 0x31 || head[3] != 0x01) {
        throwFileError(path, "is not an OpenEXR file");
    }
    if (head[4] > kNewestVersion) {
        throwFileError(path, "OpenEXR version " + std::to_string(int{head[4]}) +
                                 ", expected at most " + std::to_string(kNewestVersion));
    }
}

bool isDeep(const Imf::Header& header) {
    return header.hasType() && Imf::isDeepData(header.type());
}

bool hasRgb(const Imf::ChannelList& channels) {
    return channels.findChannel("R") && channels.findChannel("G") && channels.findChannel("B");
}

/// First flat part with R, G, B or Y.
int colorPart(const std::filesystem::path& path, const Imf::MultiPartInputFile& file) {
    std::string found;
    bool deep = false;
    for (int part = 0; part < file.parts(); ++part) {
        const Imf::ChannelList& channels = file.header(part).channels();
        if (isDeep(file.header(part))) {
            deep = true;
        } else if (hasRgb(channels) || channels.findChannel("Y")) {
            return part;
        }
        for (auto c = channels.begin(); c != channels.end(); ++c) {
            found += (found.empty() ? "" : ", ") + std::string(c.name());
        }
    }
    throwFileError(path, std::string(deep ? "deep image with the channels " : "channels ") + found +
                             ", expected a flat image with R, G, B or Y");
}

Imath::Box2i checkedWindow(const std::filesystem::path& path, const Imf::MultiPartInputFile& file,
                           int part) {
    if (!file.partComplete(part)) throwFileError(path, "truncated: some of its pixels are missing");
    const Imath::Box2i window = file.header(part).dataWindow();
    const double width = static_cast<double>(window.max.x) - window.min.x + 1.0;
    const double height = static_cast<double>(window.max.y) - window.min.y + 1.0;
    if (width * height > kMaxPixels) {
        throwFileError(path, "data window of " + std::to_string(static_cast<long long>(width)) +
                                 " x " + std::to_string(static_cast<long long>(height)) +
                                 " pixels, expected at most 2^29");
    }
    return window;
}

Imf::MultiPartInputFile openFile(const std::filesystem::path& path) {
    requireKnownVersion(path);
    requireSoundExrHeader(path);
    Imf::Header::setMaxImageSize(kMaxSide, kMaxSide);
    Imf::Header::setMaxTileSize(kMaxSide, kMaxSide);
    return Imf::MultiPartInputFile(path.c_str());
}

void requireFullResolution(const std::filesystem::path& path, const std::string& name,
                           const Imf::Channel& channel) {
    if (channel.xSampling != 1 || channel.ySampling != 1) {
        throwFileError(path, "channel " + name + " is subsampled, expected full resolution");
    }
}

/// Reads channels as float, `target(name)` giving the place of each one's first value.
template <class Target>
void readChannels(Imf::MultiPartInputFile& file, int part, const std::vector<std::string>& names,
                  std::size_t valueStride, const Target& target) {
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
    input.readPixels(window.min.y, window.max.y);
}

/// Subsampled channel, interpolated between its values.
struct ChromaPlane {
    int xSampling;
    int ySampling;
    int width;
    int height;
    std::vector<float> values;

    ChromaPlane(const Imf::Channel& channel, const Image& image)
        : xSampling(channel.xSampling),
          ySampling(channel.ySampling),
          width(image.width / xSampling),
          height(image.height / ySampling),
          values(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {}

    float at(int x, int y) const {
        const auto value = [&](int column, int row) {
            return values[static_cast<std::size_t>(std::min(row, height - 1)) *
                              static_cast<std::size_t>(width) +
                          static_cast<std::size_t>(std::min(column, width - 1))];
        };
        const int column = x / xSampling;
        const int row = y / ySampling;
        const float u = static_cast<float>(x % xSampling) / static_cast<float>(xSampling);
        const float v = static_cast<float>(y % ySampling) / static_cast<float>(ySampling);
        return std::lerp(std::lerp(value(column, row), value(column + 1, row), u),
                         std::lerp(value(column, row + 1), value(column + 1, row + 1), u), v);
    }
};

/// Y, RY = (R - Y) / Y and BY = (B - Y) / Y to R, G, B.
void readChroma(Imf::MultiPartInputFile& file, int part, Image& image) {
    const Imf::Header& header = file.header(part);
    ChromaPlane ry(header.channels()["RY"], image);
    ChromaPlane by(header.channels()["BY"], image);
    std::vector<float> luma(image.pixels.size());
    readChannels(file, part, {"Y", "RY", "BY"}, sizeof(float), [&](const std::string& name) {
        return name == "Y" ? luma.data() : name == "RY" ? ry.values.data() : by.values.data();
    });
    const Vec3f weights = Imf::RgbaYca::computeYw(
        Imf::hasChromaticities(header) ? Imf::chromaticities(header) : Imf::Chromaticities());
    for (std::size_t i = 0; i < luma.size(); ++i) {
        const int x = static_cast<int>(i % static_cast<std::size_t>(image.width));
        const int y = static_cast<int>(i / static_cast<std::size_t>(image.width));
        const float r = (ry.at(x, y) + 1.0f) * luma[i];
        const float b = (by.at(x, y) + 1.0f) * luma[i];
        image.pixels[i] = {r, (luma[i] - r * weights.x - b * weights.z) / weights.y, b};
    }
}

Rgb luminanceWeights(const std::filesystem::path& path, const Imf::Header& header) {
    if (!Imf::hasChromaticities(header)) return RadianceImage{}.luminanceWeights;
    const Vec3f yw = Imf::RgbaYca::computeYw(Imf::chromaticities(header));
    if (!std::isfinite(yw.x) || !std::isfinite(yw.y) || !std::isfinite(yw.z)) {
        throwFileError(path, "chromaticities without a luminance, expected three primaries");
    }
    const Rgb weights(std::max(yw.x, kLeastLuminanceWeight), std::max(yw.y, kLeastLuminanceWeight),
                      std::max(yw.z, kLeastLuminanceWeight));
    return weights / (weights.x + weights.y + weights.z);
}

}  // namespace

RadianceImage readExrRadiance(const std::filesystem::path& path) {
    return translated(path, [&] {
        Imf::MultiPartInputFile file = openFile(path);
        const int part = colorPart(path, file);
        const Imf::Header& header = file.header(part);
        const Imath::Box2i window = checkedWindow(path, file, part);

        RadianceImage result;
        result.luminanceWeights = luminanceWeights(path, header);
        Image& image = result.image;
        image.width = window.max.x - window.min.x + 1;
        image.height = window.max.y - window.min.y + 1;
        image.pixels.resize(static_cast<std::size_t>(image.width) *
                            static_cast<std::size_t>(image.height));
        const Imf::ChannelList& channels = header.channels();
        for (const char* name : {"R", "G", "B", "Y"}) {
            const Imf::Channel* channel = channels.findChannel(name);
            if (channel) requireFullResolution(path, name, *channel);
        }
        Rgb& first = image.pixels[0];
        if (hasRgb(channels)) {
            readChannels(file, part, {"R", "G", "B"}, sizeof(Rgb), [&](const std::string& name) {
                return name == "R" ? &first.x : name == "G" ? &first.y : &first.z;
            });
        } else if (channels.findChannel("RY") && channels.findChannel("BY")) {
            readChroma(file, part, image);
        } else {
            readChannels(file, part, {"Y"}, sizeof(Rgb),
                         [&](const std::string&) { return &first.x; });
            for (Rgb& pixel : image.pixels) pixel.y = pixel.z = pixel.x;
        }
        return result;
    });
}

ExrFile readExr(const std::filesystem::path& path) {
    return translated(path, [&] {
        Imf::MultiPartInputFile file = openFile(path);
        const Imf::Header& header = file.header(0);
        if (isDeep(header)) throwFileError(path, "deep image, expected a flat one");
        const Imath::Box2i window = checkedWindow(path, file, 0);

        ExrFile result;
        result.width = window.max.x - window.min.x + 1;
        result.height = window.max.y - window.min.y + 1;
        const Imath::Box2i display = header.displayWindow();
        result.place = {window.min.x - display.min.x, window.min.y - display.min.y,
                        display.max.x - display.min.x + 1, display.max.y - display.min.y + 1};
        const auto pixels =
            static_cast<std::size_t>(result.width) * static_cast<std::size_t>(result.height);
        std::vector<std::string> names;
        for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
            requireFullResolution(path, c.name(), c.channel());
            names.emplace_back(c.name());
            result.channels.push_back({c.name(), std::vector<float>(pixels)});
        }
        std::size_t next = 0;
        readChannels(file, 0, names, sizeof(float),
                     [&](const std::string&) { return result.channels[next++].values.data(); });
        for (auto a = header.begin(); a != header.end(); ++a) {
            if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&a.attribute())) {
                result.metadata[a.name()] = text->value();
            }
        }
        return result;
    });
}

}  // namespace shadowcache
