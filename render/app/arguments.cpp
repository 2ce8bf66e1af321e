#include "render/app/arguments.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "common/base/error.h"
#include "common/base/take_text.h"
#include "common/base/text_streams.h"
#include "common/cli/command_line.h"
#include "common/shot/frames.h"
#include "render/library/pixel_rays.h"
#include "render/library/wanted.h"

namespace shadowcache {

namespace {

/// "A,B,C" -> finite numbers, as many as `count`.
std::vector<double> parseNumbers(const char* option, const std::string& text, std::size_t count,
                                 const char* wanted) {
    std::vector<double> numbers;
    TextReader parts(text);
    std::string part;
    while (std::getline(parts, part, ',')) {
        double number = 0;
        TextReader field(part);
        if (!(field >> number) || !field.eof() || !std::isfinite(number)) break;
        numbers.push_back(number);
    }
    if (numbers.size() != count || !parts.eof())
        throw Error(std::string(option) + " " + text + ": expected " + wanted);
    return numbers;
}

Vec3d parseVector(const char* option, const std::string& text, const char* wanted) {
    const std::vector<double> v = parseNumbers(option, text, 3, wanted);
    return {v[0], v[1], v[2]};
}

/// "X,Y,WxH".
FilmRectangle parseCrop(const std::string& text) {
    FilmRectangle crop;
    std::string_view rest = text;
    if (takeNumber(rest, crop.x) && takeCharacter(rest, ',') && takeNumber(rest, crop.y) &&
        takeCharacter(rest, ',') && takeNumber(rest, crop.width) && takeCharacter(rest, 'x') &&
        takeNumber(rest, crop.height) && rest.empty())
        return crop;
    throw Error("--crop " + text + ": expected X,Y,WxH, as in 100,50,320x180");
}

/// "KEY=VALUE,...".
Gloss parseMaterial(const std::string& text) {
    Gloss gloss;
    const std::array<std::pair<const char*, float*>, 4> keys{{{"roughness", &gloss.roughness},
                                                              {"metallic", &gloss.metallic},
                                                              {"ior", &gloss.ior},
                                                              {"specular", &gloss.specular}}};
    TextReader parts(text);
    std::string part;
    while (std::getline(parts, part, ',')) {
        const std::size_t sign = std::min(part.find('='), part.size());
        const auto key =
            std::ranges::find(keys, part.substr(0, sign), &decltype(keys)::value_type::first);
        if (key == keys.end() || sign == part.size())
            throw Error("--material " + part +
                        ": expected roughness=, metallic=, ior= or specular= and a number");
        *key->second = static_cast<float>(
            parseNumbers("--material", part.substr(sign + 1), 1, "a number behind each =")[0]);
    }
    return gloss;
}

}  // namespace

RenderJob jobOf(const Arguments& arguments) {
    RenderJob job = arguments.job;
    if (!arguments.eye.empty()) {
        job.camera.eye = parseVector("--eye", arguments.eye, "X,Y,Z");
        job.camera.lookAt = parseVector("--look-at", arguments.target, "X,Y,Z");
    }
    job.files = arguments.shot.files;
    job.mesh = meshOptionsOf(arguments.shot, job.mesh);
    job.camera.name = arguments.shot.camera;
    job.camera.shutter = arguments.shot.shutter;
    job.fps = arguments.shot.fps;
    job.dynamic = dynamicFilesOf(arguments.shot);
    if (!(job.mesh.smoothDegrees >= 0 && job.mesh.smoothDegrees <= 180))
        throw Error(fmt::format("--smooth {:f}: expected an angle from 0 to 180 degrees",
                                job.mesh.smoothDegrees));
    if (!job.mesh.shadingNormals && job.mesh.smoothDegrees > 0)
        throw Error(
            "--smooth makes shading normals, --normals geometric has none: expected one of them");
    if (!arguments.memory.empty()) job.memory = parseSize("--memory", arguments.memory);
    job.framesGiven = !arguments.shot.frames.empty();
    if (job.framesGiven) job.frames = parseFrames(arguments.shot.frames);
    if (!arguments.shotFrames.empty())
        job.shotFrames = parseFrames(arguments.shotFrames, "--shot-frames");
    const auto [width, height] = sizeOf(arguments.shot);
    job.render.width = width;
    job.render.height = height;
    if (!arguments.crop.empty()) job.render.crop = parseCrop(arguments.crop);
    job.targetError = arguments.targetError.value_or(0);
    chooseRays({arguments.spp, arguments.cameraRays, arguments.samples, arguments.preview,
                arguments.targetError},
               estimatorOf(job), job.render);
    const bool grey = arguments.albedo.find(',') == std::string::npos;
    job.render.plain.albedo =
        Rgb(grey ? Vec3d(parseNumbers("--albedo", arguments.albedo, 1, "one value, or R,G,B")[0])
                 : parseVector("--albedo", arguments.albedo, "one value, or R,G,B"));
    job.render.bounces =
        arguments.bounces.empty() ? kStandardBounces : parseBounces(arguments.bounces);
    if (!arguments.material.empty()) job.render.plain.gloss = parseMaterial(arguments.material);
    if (!arguments.material.empty() && !job.mesh.gloss)
        throw Error(
            "--material makes surfaces glossy, --surfaces diffuse leaves gloss out: "
            "expected one of them");
    if (!arguments.debug.empty())
        job.debugPixel = parsePair("--debug", arguments.debug, "a pixel, X,Y");
    return job;
}

}  // namespace shadowcache
