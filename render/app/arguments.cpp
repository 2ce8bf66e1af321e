#include "render/app/arguments.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <regex>

#include "common/base/error.h"
#include "common/base/option_checks.h"
#include "common/base/text_streams.h"
#include "common/cli/command_line.h"
#include "common/shot/frames.h"

namespace shadowcache {

namespace {

/// Above 0, which no number of rays reaches: the rounding of floats, squared.
constexpr double kLeastTargetError = 1e-14;

/// Samples of a camera ray where --target-error chooses the camera rays.
constexpr int kTargetErrorSamples = 4;

/// Camera rays of a pixel of a preview, with one sample each.
constexpr int kPreviewCameraRays = 4;

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
    static const std::regex crop(R"((\d{1,5}),(\d{1,5}),(\d{1,5})x(\d{1,5}))");
    std::smatch match;
    if (!std::regex_match(text, match, crop))
        throw Error("--crop " + text + ": expected X,Y,WxH, as in 100,50,320x180");
    return {std::stoi(match[1]), std::stoi(match[2]), std::stoi(match[3]), std::stoi(match[4])};
}

/// A number of bounces, or "unlimited".
int parseBounces(const std::string& text) {
    if (text == "unlimited") return kUnlimitedBounces;
    int bounces = 0;
    TextReader number(text);
    if (!(number >> bounces) || !number.eof() || bounces < 0 || bounces > kMostBounces)
        throw Error("--bounces " + text + ": expected a number from 0 to " +
                    std::to_string(kMostBounces) + ", or unlimited");
    return bounces;
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

std::ptrdiff_t placeOf(const std::string& name, const std::vector<std::string>& names) {
    return std::find(names.begin(), names.end(), name) - names.begin();
}

}  // namespace

const std::vector<std::string>& sequenceNames() {
    static const std::vector<std::string> names{"sobol", "random", "larcher-xor", "larcher-shift"};
    return names;
}

RenderJob jobOf(const Arguments& arguments) {
    RenderJob job = arguments.job;
    if (!arguments.eye.empty()) {
        job.camera.eye = parseVector("--eye", arguments.eye, "X,Y,Z");
        job.camera.lookAt = parseVector("--look-at", arguments.target, "X,Y,Z");
    }
    job.mesh.shadingNormals = arguments.normals == "shading";
    if (!(job.mesh.smoothDegrees >= 0 && job.mesh.smoothDegrees <= 180))
        throw Error("--smooth " + std::to_string(job.mesh.smoothDegrees) +
                    ": expected an angle from 0 to 180 degrees");
    if (!job.mesh.shadingNormals && job.mesh.smoothDegrees > 0)
        throw Error(
            "--smooth makes shading normals, --normals geometric has none: expected one of them");
    if (!arguments.memory.empty()) job.memory = parseSize("--memory", arguments.memory);
    for (const std::string& text : arguments.dynamic) job.dynamic.push_back(parseDynamic(text));
    job.framesGiven = !arguments.frames.empty();
    if (job.framesGiven) job.frames = parseFrames(arguments.frames);
    if (!arguments.shotFrames.empty())
        job.shotFrames = parseFrames(arguments.shotFrames, "--shot-frames");
    const auto [width, height] = parsePair("--size", arguments.size, "WxH, as in 960x540");
    job.render.width = width;
    job.render.height = height;
    if (!arguments.crop.empty()) job.render.crop = parseCrop(arguments.crop);
    job.render.filter = static_cast<FilterKind>(placeOf(arguments.filter, filterNames()));
    if (arguments.targetError) {
        requireRange("target-error", *arguments.targetError, kLeastTargetError, 1e6);
        job.targetError = *arguments.targetError;
        if (!arguments.samplesGiven) job.render.samples = kTargetErrorSamples;
    }
    if (job.render.preview) {
        if (!arguments.samplesGiven) job.render.samples = 1;
        if (!arguments.cameraRaysGiven) job.render.cameraRays = kPreviewCameraRays;
    }
    if (arguments.spp) {
        requireRange("spp", *arguments.spp, 1, kMostCameraRays);
        job.render.cameraRays = *arguments.spp;
        job.render.samples = 1;
    }
    const bool grey = arguments.albedo.find(',') == std::string::npos;
    job.render.plain.albedo =
        Rgb(grey ? Vec3d(parseNumbers("--albedo", arguments.albedo, 1, "one value, or R,G,B")[0])
                 : parseVector("--albedo", arguments.albedo, "one value, or R,G,B"));
    job.render.bounces = arguments.bounces.empty() ? estimatorOf(job).standardBounces()
                                                   : parseBounces(arguments.bounces);
    job.mesh.gloss = arguments.surfaces == "glossy";
    if (!arguments.material.empty()) job.render.plain.gloss = parseMaterial(arguments.material);
    if (!arguments.material.empty() && !job.mesh.gloss)
        throw Error(
            "--material makes surfaces glossy, --surfaces diffuse leaves gloss out: "
            "expected one of them");
    if (!arguments.debug.empty())
        job.debugPixel = parsePair("--debug", arguments.debug, "a pixel, X,Y");
    job.mesh.zUp = arguments.up == "z";
    job.mesh.stillAt = timeOf(arguments.setFrame, job.fps);
    if (arguments.allowExternal) job.mesh.references = References::anywhere;
    job.sequence = static_cast<Sequence>(placeOf(arguments.sequence, sequenceNames()));
    job.estimatorOptions.paper.exactConvolution = arguments.convolution == "exact";
    const auto [pixelWidth, pixelHeight] =
        parsePair("--pixel-map", arguments.pixelMap, "WxH, as in 200x100");
    job.estimatorOptions.pixel.width = pixelWidth;
    job.estimatorOptions.pixel.height = pixelHeight;
    job.estimatorOptions.cache.adaptive = arguments.budget == "adaptive";
    job.estimatorOptions.paper.minLevel =
        std::min(job.estimatorOptions.paper.minLevel, job.estimatorOptions.paper.maxLevel);
    return job;
}

}  // namespace shadowcache
