#include "common/image/exr_radiance.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfChromaticitiesAttribute.h>
#include <OpenEXR/ImfRgbaYca.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <string>
#include <string_view>

#include "common/base/error.h"
#include "common/base/report_failure.h"
#include "common/image/exr_colors.h"
#include "common/image/exr_error.h"
#include "common/image/exr_file.h"
#include "common/image/primaries.h"
#include "common/image/size_limits.h"

namespace shadowcache {

namespace {

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

std::array<float, 8> numbersOf(const Imf::Chromaticities& c) {
    return {c.red.x, c.red.y, c.green.x, c.green.y, c.blue.x, c.blue.y, c.white.x, c.white.y};
}

void requireLatLong(const std::filesystem::path& path, const Imf::Header& header) {
    if (!Imf::hasEnvmap(header) || Imf::envmap(header) == Imf::ENVMAP_LATLONG) return;
    const Imf::Envmap kind = Imf::envmap(header);
    throwFileError(path,
                   fmt::format("envmap = {}, expected a lat-long map",
                               kind == Imf::ENVMAP_CUBE ? "cube" : std::to_string(int{kind})));
}

/// Whether a name that programs give to colour spaces is of linear colours: of Rec. 709, or of the
/// primaries that the file states.
bool isLinear(std::string name, bool statesPrimaries) {
    std::ranges::transform(name, name.begin(),
                           [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    constexpr std::array<std::string_view, 8> kOfRec709{
        "linear",   "scene_linear",   "lin_rec709",  "lin_rec709_scene",
        "lin_srgb", "linear rec.709", "linear srgb", "linear rec.709 (srgb)"};
    return std::ranges::find(kOfRec709, name) != kOfRec709.end() ||
           (statesPrimaries && name.starts_with("lin"));
}

/// Names a colour space that texels are not converted from.
void noteColorSpace(const Imf::Header& header, RadianceImage& result) {
    constexpr std::size_t kMostBytes = 60;
    for (const char* name : {"colorInteropID", "oiio:ColorSpace"}) {
        const auto* space = header.findTypedAttribute<Imf::StringAttribute>(name);
        if (!space || isLinear(space->value(), Imf::hasChromaticities(header))) continue;
        result.notes.push_back(oneLine(
            fmt::format("{} is {}, which is left out: texels are taken for linear, with the "
                        "primaries of its chromaticities, or of Rec. 709 where it has none",
                        name, space->value().substr(0, kMostBytes))));
    }
}

struct Window {
    long long left, top, width, height;

    explicit Window(const Imath::Box2i& box)
        : left(box.min.x),
          top(box.min.y),
          width(static_cast<long long>(box.max.x) - box.min.x + 1),
          height(static_cast<long long>(box.max.y) - box.min.y + 1) {}
};

std::string sizeOf(const Window& window) {
    return fmt::format("{}x{}", window.width, window.height);
}

/// The pixels of the data window at their places in the display window; outside of them 0.
Image onDisplay(const std::filesystem::path& path, const Image& data, const Window& from,
                const Window& to) {
    const long long left = std::max(from.left, to.left), top = std::max(from.top, to.top);
    const long long right = std::min(from.left + from.width, to.left + to.width);
    const long long bottom = std::min(from.top + from.height, to.top + to.height);
    if (left >= right || top >= bottom)
        throwFileError(path, "data window of " + sizeOf(from) + " pixels outside of the display " +
                                 "window of " + sizeOf(to) + ", expected one that it shows");
    Image image{static_cast<int>(to.width), static_cast<int>(to.height), {}};
    image.pixels.assign(static_cast<std::size_t>(to.width * to.height), Rgb(0.0f));
    for (long long y = top; y < bottom; ++y) {
        const auto first = data.pixels.begin() + (y - from.top) * from.width + (left - from.left);
        std::copy(first, first + (right - left),
                  image.pixels.begin() + (y - to.top) * to.width + (left - to.left));
    }
    return image;
}

/// A map covers the display window, whatever part of it the file has pixels of.
void fitToDisplay(const std::filesystem::path& path, const Imath::Box2i& dataWindow,
                  const Imath::Box2i& displayWindow, RadianceImage& result) {
    if (dataWindow == displayWindow) return;
    const Window from(dataWindow), to(displayWindow);
    const double pixels = static_cast<double>(to.width) * static_cast<double>(to.height);
    if (pixels > kMostExrPixels || !mayHoldValues(std::filesystem::file_size(path), 3 * pixels))
        throwFileError(
            path, "display window of " + sizeOf(to) + " pixels, too large for a file of its size");
    result.image = onDisplay(path, result.image, from, to);
    result.notes.push_back(
        fmt::format("data window of {} pixels at {},{} of a display window of {}, which the map "
                    "covers; 0 where there is no pixel",
                    sizeOf(from), from.left - to.left, from.top - to.top, sizeOf(to)));
}

void readPlanes(Imf::MultiPartInputFile& file, const ExrColors& colors, Image& image) {
    Rgb& first = image.pixels[0];
    const auto& names = colors.channels;
    if (names.size() == 3 && names[1] == "RY") {
        readChroma(file, colors.part, image);
    } else if (names.size() == 3) {
        readChannels(file, colors.part, names, sizeof(Rgb), [&](const std::string& name) {
            return name == names[0] ? &first.x : name == names[1] ? &first.y : &first.z;
        });
    } else {
        readChannels(file, colors.part, names, sizeof(Rgb),
                     [&](const std::string&) { return &first.x; });
        for (Rgb& pixel : image.pixels) pixel.y = pixel.z = pixel.x;
    }
}

}  // namespace

RadianceImage readExrRadiance(const std::filesystem::path& path) {
    return translated(path, [&] {
        Imf::MultiPartInputFile file = openExr(path);
        const ExrColors colors = chooseColors(path, file);
        const Imf::Header& header = file.header(colors.part);
        requireLatLong(path, header);
        const Imath::Box2i window = checkedWindow(path, file, colors.part);
        for (const std::string& name : colors.channels)
            if (name != "RY" && name != "BY")
                requireFullResolution(path, name, header.channels()[name]);

        RadianceImage result;
        if (!colors.note.empty()) result.notes.push_back(colors.note);
        if (Imf::hasChromaticities(header))
            setPrimaries(path, numbersOf(Imf::chromaticities(header)), result);
        noteColorSpace(header, result);
        Image& image = result.image;
        image.width = window.max.x - window.min.x + 1;
        image.height = window.max.y - window.min.y + 1;
        image.pixels.resize(static_cast<std::size_t>(image.width) *
                            static_cast<std::size_t>(image.height));
        readPlanes(file, colors, image);
        // With the attribute the map is the data window. [ImfEnvmap.h]
        if (!Imf::hasEnvmap(header)) fitToDisplay(path, window, header.displayWindow(), result);
        return result;
    });
}

}  // namespace shadowcache
