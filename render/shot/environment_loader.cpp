#include "render/shot/environment_loader.h"

#include <cstdio>

#include "common/image/radiance.h"

namespace shadowcache {

namespace {

RadianceImage readMap(const std::string& environment) {
    if (const auto color = parseRadiance(environment)) {
        RadianceImage map;
        map.image = {1, 1, {*color}};
        return map;
    }
    RadianceImage map = readRadiance(environment);
    if (map.image.width != 2 * map.image.height)
        std::fprintf(stderr,
                     "shadowcache-render: warning: %s: %dx%d texels, a lat-long map is 2:1\n",
                     environment.c_str(), map.image.width, map.image.height);
    for (const std::string& note : map.notes) std::printf("map: %s\n", note.c_str());
    return map;
}

}  // namespace

EnvironmentLoader::EnvironmentLoader(const LightPlan& plan) : plan_(plan) {}

bool EnvironmentLoader::load(std::size_t i) {
    const LightPlan::Light& light = plan_.at(i);
    if (environment_ && light == current_) return false;
    if (!environment_ || light.environment != current_.environment) {
        environment_.reset();
        const RadianceImage map = readMap(light.environment);
        environment_ = std::make_unique<Environment>(
            std::make_shared<const EnvironmentMap>(map.image, map.luminanceWeights),
            light.rotation.turn(), Rgb(light.gain));
    } else {
        environment_->turn(light.rotation.turn(), Rgb(light.gain));
    }
    current_ = light;
    return true;
}

}  // namespace shadowcache
