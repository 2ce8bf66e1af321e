#include "render/shot/environment_loader.h"

#include <fmt/core.h>

#include <system_error>
#include <utility>

#include "common/image/radiance.h"

namespace shadowcache {

namespace {

RadianceImage readMap(const std::string& environment, const NoteSink& note) {
    if (const auto color = parseRadiance(environment)) {
        RadianceImage map;
        map.image = {1, 1, {*color}};
        return map;
    }
    RadianceImage map = readRadiance(environment);
    if (map.image.width != 2 * map.image.height)
        note(fmt::format("{}: {}x{} texels, a lat-long map is 2:1", environment, map.image.width,
                         map.image.height),
             NoteKind::warning);
    for (const std::string& text : map.notes) note(text, NoteKind::note);
    return map;
}

std::optional<std::filesystem::file_time_type> timeOfFile(const std::string& path) {
    std::error_code none;
    const auto time = std::filesystem::last_write_time(path, none);
    return none ? std::nullopt : std::optional(time);
}

}  // namespace

EnvironmentLoader::EnvironmentLoader(NoteSink note) : note_(std::move(note)) {}

bool EnvironmentLoader::load(const LightPlan::Light& light) {
    const auto written = timeOfFile(light.environment);
    const bool sameMap =
        environment_ && light.environment == current_.environment && written == written_;
    if (sameMap && light == current_) return false;
    if (sameMap) {
        turn(light);
    } else {
        environment_.reset();
        const RadianceImage map = readMap(light.environment, note_);
        chromaticities_ = map.chromaticities;
        environment_ = std::make_unique<Environment>(
            std::make_shared<const EnvironmentMap>(map.image, map.luminanceWeights),
            light.rotation.turn(), Rgb(light.gain));
    }
    current_ = light;
    written_ = written;
    return true;
}

void EnvironmentLoader::turn(const LightPlan::Light& light) {
    try {
        environment_->turn(light.rotation.turn(), Rgb(light.gain));
    } catch (...) {
        environment_.reset();  // it is half turned
        throw;
    }
}

}  // namespace shadowcache
