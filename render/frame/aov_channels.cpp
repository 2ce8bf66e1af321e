#include "render/frame/aov_channels.h"

#include <algorithm>
#include <array>
#include <functional>

#include "common/base/error.h"

namespace shadowcache {

namespace {

struct Aov {
    std::string name;
    std::vector<std::string> parts;  ///< channel suffixes
    std::function<float(const Pixel&, int)> value;
    std::optional<AovScale> scale = std::nullopt;
    bool insight = false;
};

template <auto Member>
float valueOf(const Pixel& p) {
    return p.*Member;
}

/// An AOV of one channel that is drawn in false colour.
template <auto Member>
Aov scalarAov(const char* name, float most) {
    return {name,
            {"Y"},
            [](const Pixel& p, int) { return p.*Member; },
            AovScale{most, valueOf<Member>},
            true};
}

const std::vector<Aov>& aovTable() {
    static const std::vector<std::string> rgb{"R", "G", "B"}, xyz{"X", "Y", "Z"};
    static const std::vector<Aov> table{
        {"irradiance", rgb, [](const Pixel& p, int k) { return p.irradiance[k]; }},
        {"diffuse", rgb, [](const Pixel& p, int k) { return p.diffuse[k]; }},
        {"glossy", rgb, [](const Pixel& p, int k) { return p.glossy[k]; }},
        {"diffuse_direct", rgb,
         [](const Pixel& p, int k) { return p.diffuse[k] - p.diffuseIndirect[k]; }},
        {"diffuse_indirect", rgb, [](const Pixel& p, int k) { return p.diffuseIndirect[k]; }},
        {"diffuse_color", rgb, [](const Pixel& p, int k) { return p.diffuseAlbedo[k]; }},
        {"glossy_direct", rgb,
         [](const Pixel& p, int k) { return p.glossy[k] - p.glossyIndirect[k]; }},
        {"glossy_indirect", rgb, [](const Pixel& p, int k) { return p.glossyIndirect[k]; }},
        {"glossy_color", rgb, [](const Pixel& p, int k) { return p.mirrorColor[k]; }},
        {"emission", rgb, [](const Pixel& p, int k) { return p.emission[k]; }},
        {"environment", rgb, [](const Pixel& p, int k) { return p.environment[k]; }},
        {"albedo", rgb, [](const Pixel& p, int k) { return p.albedo[k]; }},
        {"roughness", {"Y"}, [](const Pixel& p, int) { return p.roughness; }},
        {"normal", xyz, [](const Pixel& p, int k) { return p.normal[k]; }},
        {"position", xyz, [](const Pixel& p, int k) { return p.position[k]; }},
        {"depth", {"Z"}, [](const Pixel& p, int) { return p.depth; }},
        {"axial_depth", {"Z"}, [](const Pixel& p, int) { return p.axialDepth; }},
        {"variance", {"Y"}, [](const Pixel& p, int) { return p.variance; }},
        {"rays", {"Y"}, [](const Pixel& p, int) { return p.rays; }},
        {"camera_rays", {"Y"}, [](const Pixel& p, int) { return p.cameraRays; }},
        scalarAov<&Pixel::openness>("openness", 1),
        scalarAov<&Pixel::expectedNoise>("expected_noise", 0),
        scalarAov<&Pixel::items>("items", 16),
        scalarAov<&Pixel::misses>("misses", 1),
    };
    return table;
}

const Aov& findAov(const std::string& name) {
    std::string known;
    for (const Aov& aov : aovTable()) {
        if (aov.name == name) return aov;
        known += (known.empty() ? "" : ", ") + aov.name;
    }
    throw Error("--aov " + name + ": expected one of " + known);
}

Channel makeChannel(const Film& film, const std::string& name,
                    const std::function<float(const Pixel&)>& value) {
    Channel channel{name, {}};
    channel.values.reserve(film.pixels.size());
    for (const Pixel& p : film.pixels) channel.values.push_back(value(p));
    return channel;
}

}  // namespace

const std::vector<std::string>& aovNames() {
    static const std::vector<std::string> names = [] {
        std::vector<std::string> all;
        for (const Aov& aov : aovTable()) all.push_back(aov.name);
        return all;
    }();
    return names;
}

std::optional<AovScale> aovScale(const std::string& name) {
    return findAov(name).scale;
}

bool needsInsight(const std::string& aov) {
    return findAov(aov).insight;
}

std::vector<Channel> channels(const Film& film, const std::vector<std::string>& aovs) {
    std::vector<Channel> out;
    const std::array<const char*, 3> rgb{"R", "G", "B"};
    out.reserve(rgb.size());
    for (int k = 0; k < 3; ++k)
        out.push_back(makeChannel(film, rgb[static_cast<std::size_t>(k)],
                                  [k](const Pixel& p) { return p.color[k]; }));
    if (film.transparent)
        out.push_back(makeChannel(film, "A", [](const Pixel& p) { return p.alpha; }));
    for (std::size_t g = 0; g < film.groups.size(); ++g)
        for (std::size_t k = 0; k < rgb.size(); ++k) {
            Channel& channel = out.emplace_back(Channel{film.groups[g] + "." + rgb[k], {}});
            for (std::size_t i = 0; i < film.pixels.size(); ++i)
                channel.values.push_back(film.groupColors[i][g][static_cast<int>(k)]);
        }
    for (const std::string& name : aovs) {
        const Aov& aov = findAov(name);
        for (std::size_t k = 0; k < aov.parts.size(); ++k)
            out.push_back(makeChannel(film, name + "." + aov.parts[k], [&](const Pixel& p) {
                return aov.value(p, static_cast<int>(k));
            }));
    }
    return out;
}

std::string groupsText(const std::vector<std::string>& groups) {
    std::string text;
    for (const std::string& group : groups) text += group + '\n';
    return text;
}

std::vector<std::string> groupsOf(const std::string& text) {
    std::vector<std::string> groups;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t end = std::min(text.find('\n', at), text.size());
        groups.push_back(text.substr(at, end - at));
        at = end + 1;
    }
    return groups;
}

}  // namespace shadowcache
