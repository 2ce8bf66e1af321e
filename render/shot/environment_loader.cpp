#include "render/shot/environment_loader.h"

#include <cstdio>

namespace shadowcache {

EnvironmentLoader::EnvironmentLoader(const LightPlan& plan) : plan_(plan) {}

bool EnvironmentLoader::load(std::size_t i) {
    const LightPlan::Light& light = plan_.at(i);
    if (environment_ && light == current_) return false;
    environment_.reset();
    if (light.environment != current_.environment || map_.image.pixels.empty())
        loadMap(light.environment);
    current_ = light;
    environment_ = std::make_unique<Environment>(map_.image, light.rotation, map_.luminanceWeights);
    return true;
}

void EnvironmentLoader::loadMap(const std::string& environment) {
    if (const auto color = parseRadiance(environment)) {
        map_ = {};
        map_.image = {1, 1, {*color}};
        return;
    }
    map_ = readRadiance(environment);
    if (map_.image.width != 2 * map_.image.height)
        std::fprintf(stderr,
                     "shadowcache-render: warning: %s: %dx%d texels, a lat-long map is 2:1\n",
                     environment.c_str(), map_.image.width, map_.image.height);
    for (const std::string& note : map_.notes) std::printf("map: %s\n", note.c_str());
}

}  // namespace shadowcache
