#include "common/image/exr_colors.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <string_view>

#include "common/base/error.h"
#include "common/base/report_failure.h"
#include "common/image/exr_file.h"

namespace shadowcache {

namespace {

/// Names that programs give to the layer that is the picture itself.
constexpr std::array<std::string_view, 5> kMainLayers{"beauty", "color", "combined", "rgb", "rgba"};

/// Layers that a message lists, at most.
constexpr std::size_t kMostListed = 6;

struct Layer {
    int part = 0;
    std::string name;                     ///< without the channel; empty: R, G and B themselves
    std::array<std::string, 3> channels;  ///< red, green, blue
};

std::string lower(std::string_view text) {
    std::string result(text);
    std::transform(result.begin(), result.end(), result.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return result;
}

/// 0 to 2 for red, green and blue, -1 for what is none of them.
int colorOf(std::string_view channel) {
    constexpr std::array<std::string_view, 6> kNames{"r", "g", "b", "red", "green", "blue"};
    const auto found = std::find(kNames.begin(), kNames.end(), lower(channel));
    return found == kNames.end() ? -1 : static_cast<int>((found - kNames.begin()) % 3);
}

/// The layers of a part that have all three colours.
std::vector<Layer> layersOf(const Imf::ChannelList& channels, int part) {
    std::map<std::string, Layer> all;
    for (auto c = channels.begin(); c != channels.end(); ++c) {
        const std::string_view channel = c.name();
        const std::size_t dot = channel.rfind('.');
        const int color = colorOf(dot == channel.npos ? channel : channel.substr(dot + 1));
        if (color < 0) continue;
        const std::string name(channel.substr(0, dot == channel.npos ? 0 : dot));
        Layer& layer = all[name];
        layer.part = part;
        layer.name = name;
        std::string& place = layer.channels[static_cast<std::size_t>(color)];
        if (place.empty()) place = channel;
    }
    std::vector<Layer> layers;
    for (const auto& [name, layer] : all)
        if (std::none_of(layer.channels.begin(), layer.channels.end(),
                         [](const std::string& channel) { return channel.empty(); }))
            layers.push_back(layer);
    return layers;
}

std::vector<std::string> componentsOf(std::string_view name) {
    std::vector<std::string> components;
    for (std::size_t dot = name.find('.'); dot != name.npos; dot = name.find('.')) {
        components.emplace_back(name.substr(0, dot));
        name.remove_prefix(dot + 1);
    }
    components.emplace_back(name);
    return components;
}

/// Removes the layers for which `wanted` does not hold, unless it holds for none.
template <class Wanted>
void prefer(std::vector<Layer>& layers, const Wanted& wanted) {
    if (std::any_of(layers.begin(), layers.end(), wanted))
        std::erase_if(layers, [&](const Layer& layer) { return !wanted(layer); });
}

/// Leaves the layers of the first view that are named as a main picture is, if there are any.
void preferMain(const Imf::MultiPartInputFile& file, std::vector<Layer>& layers) {
    prefer(layers, [&](const Layer& layer) {
        const Imf::Header& header = file.header(layer.part);
        if (!Imf::hasMultiView(header) || Imf::multiView(header).empty()) return false;
        const auto names = componentsOf(layer.name);
        return std::find(names.begin(), names.end(), Imf::multiView(header).front()) != names.end();
    });
    prefer(layers, [](const Layer& layer) {
        const auto names = componentsOf(layer.name);
        return std::any_of(names.begin(), names.end(), [](const std::string& name) {
            return std::find(kMainLayers.begin(), kMainLayers.end(), lower(name)) !=
                   kMainLayers.end();
        });
    });
}

std::string listOf(const std::vector<Layer>& layers) {
    std::string list;
    for (std::size_t i = 0; i < std::min(layers.size(), kMostListed); ++i)
        list += (i > 0 ? ", " : "") + layers[i].name;
    return oneLine(list) + (layers.size() > kMostListed ? ", ..." : "");
}

std::string partName(const Imf::MultiPartInputFile& file, int part) {
    const Imf::Header& header = file.header(part);
    return header.hasName() ? "part '" + oneLine(header.name()) + "'"
                            : fmt::format("part {}", part);
}

ExrColors fromLayer(const Layer& layer) {
    return {layer.part, {layer.channels.begin(), layer.channels.end()}, ""};
}

[[noreturn]] void refuseChannels(const std::filesystem::path& path,
                                 const Imf::MultiPartInputFile& file) {
    std::string found;
    bool deep = false;
    for (int part = 0; part < file.parts(); ++part) {
        deep = deep || isDeep(file.header(part));
        const Imf::ChannelList& channels = file.header(part).channels();
        for (auto c = channels.begin(); c != channels.end(); ++c)
            found += (found.empty() ? "" : ", ") + std::string(c.name());
    }
    throwFileError(path, std::string(deep ? "deep image with the channels " : "channels ") + found +
                             ", expected a flat image with R, G, B or Y");
}

}  // namespace

ExrColors chooseColors(const std::filesystem::path& path, const Imf::MultiPartInputFile& file) {
    std::vector<Layer> plain, named;
    int luminancePart = -1;
    for (int part = 0; part < file.parts(); ++part) {
        if (isDeep(file.header(part))) continue;
        const Imf::ChannelList& channels = file.header(part).channels();
        for (const Layer& layer : layersOf(channels, part))
            (layer.name.empty() ? plain : named).push_back(layer);
        // Beside X it is a coordinate.
        if (luminancePart < 0 && channels.findChannel("Y") && !channels.findChannel("X"))
            luminancePart = part;
    }
    if (!plain.empty()) {
        ExrColors colors = fromLayer(plain.front());
        if (plain.size() > 1)
            colors.note = fmt::format("colours of {}, the first of {} parts that have some",
                                      partName(file, colors.part), plain.size());
        return colors;
    }
    if (luminancePart >= 0) {
        const Imf::ChannelList& channels = file.header(luminancePart).channels();
        if (channels.findChannel("RY") && channels.findChannel("BY"))
            return {luminancePart, {"Y", "RY", "BY"}, ""};
        return {luminancePart, {"Y"}, ""};
    }
    if (named.empty()) refuseChannels(path, file);
    std::vector<Layer> main = named;
    preferMain(file, main);
    if (main.size() != 1)
        throwFileError(path,
                       fmt::format("colours in {} layers ({}), expected R, G, B or one such layer",
                                   main.size(), listOf(main)));
    ExrColors colors = fromLayer(main.front());
    colors.note = "colours of the layer " + oneLine(main.front().name);
    if (named.size() > 1) colors.note += fmt::format(", of {}", named.size());
    return colors;
}

}  // namespace shadowcache
