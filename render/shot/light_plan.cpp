#include "render/shot/light_plan.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "common/base/error.h"
#include "common/base/file_bytes.h"
#include "common/base/text_streams.h"
#include "common/image/radiance.h"
#include "common/shot/frames.h"

namespace shadowcache {

namespace {

std::vector<std::string> environmentsOf(const std::string& text, std::span<const int> frames) {
    if (text.empty()) return {"0,0,0"};
    std::error_code ignored;
    if (parseRadiance(text) || std::filesystem::exists(text, ignored)) return {text};
    if (hasFrameNumber(text)) {
        std::vector<std::string> all;
        for (const int frame : frames)
            all.push_back(framePath(text, frame, FrameNames::several).string());
        return all;
    }
    std::vector<std::string> all;
    TextReader parts(text);
    for (std::string part; std::getline(parts, part, ',');) all.push_back(part);
    if (all.size() > 1 && all.size() != frames.size())
        throw Error(fmt::format("--env {}: {} maps for {} {}, expected one, or one for each frame",
                                text, all.size(), frames.size(),
                                frames.size() > 1 ? "frames" : "frame"));
    return all;
}

}  // namespace

LightPlan::LightPlan(const LightOptions& options, std::span<const int> frames,
                     std::span<const int> shot) {
    const std::span<const int> all = shot.empty() ? frames : shot;
    const std::vector<std::string> maps = environmentsOf(options.environment, all);
    const auto [first, last] = parseRotation(options.rotation);
    const Vec3d gain = gainOf(options.gain);
    for (std::size_t i = 0; i < frames.size(); ++i) {
        std::size_t place = i;
        if (!shot.empty())
            place = static_cast<std::size_t>(std::ranges::find(shot, frames[i]) - shot.begin());
        if (place == all.size())
            throw Error(fmt::format(
                "--shot-frames: frame {} of --frames is missing, expected all of them", frames[i]));
        const double share =
            all.size() > 1 ? static_cast<double>(place) / static_cast<double>(all.size() - 1) : 0;
        LightRotation rotation = first;
        for (std::size_t k = 0; k < rotation.numbers.size(); ++k)
            rotation.numbers[k] += (last.numbers[k] - first.numbers[k]) * share;
        lights_.push_back({maps[std::min(place, maps.size() - 1)], rotation, gain});
    }
}

void LightPlan::requireFiles() const {
    for (const Light& light : lights_)
        if (!parseRadiance(light.environment)) requireReadableFile(light.environment);
}

Vec3d gainOf(const std::string& text) {
    const std::vector<double> numbers = parseNumbers(text);
    const bool known = numbers.size() == 1 || numbers.size() == 3;
    if (!known || std::ranges::any_of(numbers, [](double n) { return !(n >= 0 && n <= 1e6); }))
        throw Error("--env-gain " + text + ": expected a factor, or three R,G,B, from 0 to 1e+06");
    if (numbers.size() == 1) return Vec3d(numbers[0]);
    return {numbers[0], numbers[1], numbers[2]};
}

std::optional<Rgb> parseRadiance(const std::string& text) {
    Rgb c;
    char rest = 0;
    if (std::sscanf(text.c_str(), "%f,%f,%f%c", &c.x, &c.y, &c.z, &rest) != 3) return std::nullopt;
    for (int k = 0; k < 3; ++k)
        if (!(c[k] >= 0) || std::isinf(c[k]))
            throw Error("--env " + text + ": expected three radiances of 0 or more");
    return c;
}

}  // namespace shadowcache
