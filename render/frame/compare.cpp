#include "render/frame/compare.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "common/base/error.h"
#include "common/image/exr.h"

namespace shadowcache {

RelativeError relativeError(const Image& image, const Image& reference) {
    if (image.width != reference.width || image.height != reference.height)
        throw Error(fmt::format("reference image: {}x{} pixels, expected {}x{}", reference.width,
                                reference.height, image.width, image.height));
    const std::size_t count = image.pixels.size();
    double sum = 0;
    for (const Rgb& p : reference.pixels)
        for (int k = 0; k < 3; ++k) sum += static_cast<double>(p[k]);
    const double mean = sum / (3 * static_cast<double>(count));

    std::vector<double> errors(count);
    RelativeError result;
    double squares = 0;
    for (std::size_t i = 0; i < count; ++i) {
        for (int k = 0; k < 3; ++k) {
            const auto ref = static_cast<double>(reference.pixels[i][k]);
            const double difference = static_cast<double>(image.pixels[i][k]) - ref;
            squares += difference * difference;
            const double scale = ref * ref + 0.01 * mean * mean;
            if (scale > 0) errors[i] += difference * difference / scale / 3;
        }
        result.mean += errors[i] / static_cast<double>(count);
    }
    result.l2 = std::sqrt(squares / (3 * static_cast<double>(count)));
    std::sort(errors.begin(), errors.end());
    const auto quantile = [&](double q) {
        return errors[std::min(count - 1,
                               static_cast<std::size_t>(q * static_cast<double>(count)))];
    };
    result.p50 = quantile(0.5);
    result.p99 = quantile(0.99);
    result.p999 = quantile(0.999);
    result.max = errors.back();
    return result;
}

std::vector<Rgb> tileMeans(const Image& image, int tile) {
    std::vector<Rgb> means;
    for (int y = 0; y + tile <= image.height; y += tile)
        for (int x = 0; x + tile <= image.width; x += tile) {
            double sum[3] = {0, 0, 0};
            for (int v = y; v < y + tile; ++v)
                for (int u = x; u < x + tile; ++u)
                    for (int k = 0; k < 3; ++k)
                        sum[k] += static_cast<double>(
                            image.pixels[static_cast<std::size_t>(v) *
                                             static_cast<std::size_t>(image.width) +
                                         static_cast<std::size_t>(u)][k]);
            const double scale = 1.0 / (tile * tile);
            means.emplace_back(static_cast<float>(sum[0] * scale),
                               static_cast<float>(sum[1] * scale),
                               static_cast<float>(sum[2] * scale));
        }
    return means;
}

Image readReference(const std::filesystem::path& path, const RenderOptions& options) {
    const ExrFile file = readExr(path);
    const FilmRectangle region = options.region();
    // Of the whole frame the part that was rendered is compared, whatever its data window is.
    const bool framed =
        file.place.frameWidth == options.width && file.place.frameHeight == options.height;
    const int left = framed ? region.x - file.place.x : 0;
    const int top = framed ? region.y - file.place.y : 0;
    if (framed ? left < 0 || top < 0 || left + region.width > file.width ||
                     top + region.height > file.height
               : file.width != region.width || file.height != region.height)
        throwFileError(path, fmt::format("{}x{} pixels{}, expected {}x{} as rendered", file.width,
                                         file.height, framed ? " of another part of the frame" : "",
                                         region.width, region.height));
    Image image{region.width, region.height, {}};
    image.pixels.resize(static_cast<std::size_t>(region.width) *
                        static_cast<std::size_t>(region.height));
    const std::string names = "RGB";
    for (int k = 0; k < 3; ++k) {
        const auto found =
            std::find_if(file.channels.begin(), file.channels.end(), [&](const Channel& c) {
                return c.name == names.substr(static_cast<std::size_t>(k), 1);
            });
        if (found == file.channels.end())
            throwFileError(path, "no channels R, G and B to compare with");
        std::size_t i = 0;
        for (int y = 0; y < region.height; ++y)
            for (int x = 0; x < region.width; ++x)
                image.pixels[i++][k] = found->values[static_cast<std::size_t>(top + y) *
                                                         static_cast<std::size_t>(file.width) +
                                                     static_cast<std::size_t>(left + x)];
    }
    return image;
}

}  // namespace shadowcache
