#include "common/image/exr.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFramesPerSecond.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>

#include "common/base/error.h"
#include "common/image/exr_error.h"
#include "common/image/exr_file.h"

namespace shadowcache {

namespace {

PointMatrix numbersOf(const Imath::M44f& matrix) {
    PointMatrix numbers;
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column)
            numbers[static_cast<std::size_t>(4 * row + column)] = matrix[row][column];
    return numbers;
}

ExrView viewOf(const Imf::Header& header) {
    ExrView view;
    view.pixelAspect = header.pixelAspectRatio();
    view.screenCenter = {header.screenWindowCenter().x, header.screenWindowCenter().y};
    view.screenWidth = header.screenWindowWidth();
    if (Imf::hasWorldToCamera(header)) view.worldToCamera = numbersOf(Imf::worldToCamera(header));
    if (Imf::hasWorldToNDC(header)) view.worldToNdc = numbersOf(Imf::worldToNDC(header));
    if (Imf::hasFramesPerSecond(header)) {
        const Imf::Rational& rate = Imf::framesPerSecond(header);
        if (rate.d != 0) view.framesPerSecond = static_cast<double>(rate);
    }
    if (Imf::hasChromaticities(header)) {
        const Imf::Chromaticities& c = Imf::chromaticities(header);
        view.chromaticities = Chromaticities{c.red.x,  c.red.y,  c.green.x, c.green.y,
                                             c.blue.x, c.blue.y, c.white.x, c.white.y};
    }
    return view;
}

}  // namespace

ExrFile readExr(const std::filesystem::path& path) {
    return translated(path, [&] {
        Imf::MultiPartInputFile file = openExr(path);
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
        result.view = viewOf(header);
        for (auto a = header.begin(); a != header.end(); ++a) {
            if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&a.attribute())) {
                result.metadata[a.name()] = text->value();
            }
        }
        return result;
    });
}

}  // namespace shadowcache
