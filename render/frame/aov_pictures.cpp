#include "render/frame/aov_pictures.h"

#include <algorithm>

#include "common/image/false_color.h"
#include "render/frame/aov_channels.h"

namespace shadowcache {

namespace {

/// Value that all but a hundredth of the set's pixels stay below.
float highest(const Film& film, const AovScale& scale) {
    std::vector<float> values;
    for (const Pixel& p : film.pixels)
        if (p.depth > 0) values.push_back(scale.value(p));
    if (values.empty()) return 1;
    const auto place = values.begin() + static_cast<std::ptrdiff_t>(values.size() * 99 / 100);
    std::nth_element(values.begin(), place, values.end());
    return *place > 0 ? *place : 1;
}

}  // namespace

std::vector<std::pair<std::string, std::filesystem::path>> aovPictures(
    const std::filesystem::path& png, const std::vector<std::string>& aovs) {
    std::vector<std::pair<std::string, std::filesystem::path>> pictures;
    for (const std::string& aov : aovs) {
        if (!aovScale(aov)) continue;
        auto path = png;
        pictures.emplace_back(aov, path.replace_extension("." + aov + ".png"));
    }
    return pictures;
}

Image falseColorImage(const Film& film, const std::string& aov) {
    const AovScale scale = *aovScale(aov);
    const float most = scale.most > 0 ? scale.most : highest(film, scale);
    Image image{film.width, film.height, {}};
    for (const Pixel& p : film.pixels)
        image.pixels.push_back(p.depth > 0 ? falseColor(static_cast<double>(scale.value(p) / most))
                                           : Rgb(0.0f));
    return image;
}

}  // namespace shadowcache
