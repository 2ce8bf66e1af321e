#include "common/image/exr.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfStringAttribute.h>

#include "common/base/error.h"
#include "common/image/exr_error.h"
#include "common/image/exr_file.h"

namespace shadowcache {

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
        for (auto a = header.begin(); a != header.end(); ++a) {
            if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&a.attribute())) {
                result.metadata[a.name()] = text->value();
            }
        }
        return result;
    });
}

}  // namespace shadowcache
