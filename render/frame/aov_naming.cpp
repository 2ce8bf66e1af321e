#include "render/frame/aov_naming.h"

#include <string>
#include <utility>

namespace shadowcache {

namespace {

/// A channel of ours, and what it becomes.
struct Renamed {
    const char* ours;
    std::vector<std::string> theirs;
};

const std::vector<Renamed>& arnoldNames() {
    static const std::vector<Renamed> kNames{
        {"normal.X", {"N.X"}},
        {"normal.Y", {"N.Y"}},
        {"normal.Z", {"N.Z"}},
        {"axial_depth.Z", {"Z"}},
        {"diffuse_color.R", {"diffuse_albedo.R"}},
        {"diffuse_color.G", {"diffuse_albedo.G"}},
        {"diffuse_color.B", {"diffuse_albedo.B"}},
        {"variance.Y", {"variance.R", "variance.G", "variance.B"}},
    };
    return kNames;
}

std::vector<std::string> namesOf(const std::string& ours) {
    for (const Renamed& each : arnoldNames())
        if (ours == each.ours) return each.theirs;
    return {ours};
}

}  // namespace

std::vector<Channel> named(std::vector<Channel> channels, AovNaming naming) {
    if (naming == AovNaming::shadowcache) return channels;
    std::vector<Channel> out;
    for (const Channel& channel : channels)
        for (const std::string& name : namesOf(channel.name)) out.push_back({name, channel.values});
    return out;
}

}  // namespace shadowcache
