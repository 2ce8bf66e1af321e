#include "render/serve/requests.h"

#include <fmt/core.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/base/error.h"
#include "common/base/json_depth.h"
#include "common/base/number_text.h"
#include "common/base/option_checks.h"
#include "common/base/suggestion.h"
#include "common/shot/camera_json.h"
#include "render/frame/aov_channels.h"
#include "render/serve/fields.h"

namespace shadowcache {

namespace {

using Json = nlohmann::json;

constexpr int kMostInt = std::numeric_limits<int>::max();
constexpr int kLeastInt = std::numeric_limits<int>::min();

constexpr Named<bool> kUpAxes[] = {{"y", false}, {"z", true}};
constexpr Named<bool> kNormals[] = {{"shading", true}, {"geometric", false}};
constexpr Named<bool> kSurfaces[] = {{"glossy", true}, {"diffuse", false}};
constexpr Named<bool> kBudgets[] = {{"uniform", false}, {"adaptive", true}};

std::optional<int> wholeNumber(Fields& fields, const std::string& key, int least, int most) {
    const auto found = fields.integer(key, least, most);
    return found ? std::optional(static_cast<int>(*found)) : std::nullopt;
}

Vec3d vectorOf(const std::vector<double>& numbers) {
    return numbers.size() == 1 ? Vec3d(numbers[0]) : Vec3d(numbers[0], numbers[1], numbers[2]);
}

/// Numbers as a command line has them.
std::string textOf(const std::vector<double>& numbers) {
    std::string text;
    for (const double number : numbers) {
        if (!text.empty()) text += ',';
        text += numberText(number);
    }
    return text;
}

LoadRequest parseLoad(Fields& fields) {
    LoadRequest load;
    for (const std::string& file : fields.need(fields.texts("set"), "set"))
        load.files.emplace_back(file);
    if (load.files.empty()) fields.refuse("set", "a file at least");
    load.cache = fields.text("cache").value_or("");
    load.staleOk = fields.flag("stale-ok").value_or(false);
    load.fps = fields.number("fps").value_or(load.fps);
    requireRange("fps", load.fps, 1e-3, 1e6);
    MeshOptions& mesh = load.mesh;
    mesh.zUp = fields.choice("up", kUpAxes).value_or(false);
    mesh.scale = fields.number("scale").value_or(1);
    requireScale(mesh.scale);
    mesh.stillAt = timeOf(wholeNumber(fields, "set-frame", kLeastInt, kMostInt), load.fps);
    if (fields.flag("allow-external").value_or(false)) mesh.references = References::anywhere;
    mesh.shadingNormals = fields.choice("normals", kNormals).value_or(true);
    mesh.gloss = fields.choice("surfaces", kSurfaces).value_or(true);
    mesh.smoothDegrees = fields.number("smooth").value_or(0);
    requireRange("smooth", mesh.smoothDegrees, 0.0, 180.0);
    for (const std::string& text : fields.texts("dynamic").value_or(std::vector<std::string>{}))
        load.dynamic.push_back(parseDynamic(text));
    return load;
}

EnvironmentRequest parseEnvironment(Fields& fields) {
    const auto map = fields.text("map");
    const auto radiance = fields.numbers("radiance", {1, 3});
    if (map.has_value() == radiance.has_value())
        throw Error("environment: expected map or radiance, one of them");
    const std::vector<double> gain = fields.numbers("gain", {1, 3}).value_or(std::vector{1.0});
    const std::vector<double> turn = fields.numbers("rotate", {1, 3, 9}).value_or(std::vector{0.0});
    const Vec3d constant = radiance ? vectorOf(*radiance) : Vec3d(0.0);
    const LightOptions options{map ? *map : textOf({constant.x, constant.y, constant.z}),
                               textOf(turn), textOf(gain)};
    if (map && parseRadiance(*map)) fields.refuse("map", "a file");
    const LightRotation rotation =
        turn.size() == 1 ? LightRotation{turn} : parseRotation(options.rotation).first;
    if (turn.size() == 1) requireRange("env-rotate", turn[0], -1e6, 1e6);
    const Vec3d factor = gainOf(options.gain);
    if (radiance) parseRadiance(options.environment);
    return {{options.environment, rotation, factor}};
}

CameraRequest parseCamera(Fields& fields, const Json& json) {
    if (const auto name = fields.text("name")) {
        CameraOptions options;
        options.name = *name;
        options.shutter = fields.number("shutter").value_or(0);
        requireRange("shutter", options.shutter, 0.0, 1.0);
        return {options};
    }
    if (fields.has("eye")) {
        CameraOptions options;
        options.eye = vectorOf(fields.need(fields.numbers("eye", {3}), "eye"));
        options.lookAt = vectorOf(fields.need(fields.numbers("look-at", {3}), "look-at"));
        options.fovYDegrees = fields.number("fov-y").value_or(options.fovYDegrees);
        requireRange("fov-y", options.fovYDegrees, 0.01, 179.0);
        return {CameraSource(options, {}).at(1)};
    }
    const auto stated = json.find("view");
    if (stated == json.end()) throw Error("camera: expected name, eye with look-at, or view");
    fields.object("view");
    return {cameraOf(*stated, "camera: view")};
}

SizeRequest parseSize(Fields& fields) {
    RenderOptions options;
    options.width = fields.need(wholeNumber(fields, "width", kLeastInt, kMostInt), "width");
    options.height = fields.need(wholeNumber(fields, "height", kLeastInt, kMostInt), "height");
    validate(options);
    return {options.width, options.height};
}

RegionRequest parseRegion(Fields& fields) {
    const char* const keys[] = {"x", "y", "width", "height"};
    if (std::ranges::none_of(keys, [&](const char* key) { return fields.has(key); })) return {};
    const auto number = [&](const char* key, int least) {
        return fields.need(wholeNumber(fields, key, least, kMostInt), key);
    };
    return {FilmRectangle{number("x", 0), number("y", 0), number("width", 1), number("height", 1)}};
}

Gloss parseMaterial(Fields fields) {
    Gloss gloss;
    const auto read = [&](const char* key, float& value) {
        if (const auto found = fields.number(key)) value = static_cast<float>(*found);
    };
    read("roughness", gloss.roughness);
    read("metallic", gloss.metallic);
    read("ior", gloss.ior);
    read("specular", gloss.specular);
    fields.requireNoOthers();
    return gloss;
}

std::optional<int> bouncesOf(Fields& fields) {
    if (!fields.hasText("bounces")) return wholeNumber(fields, "bounces", 0, kMostBounces);
    return parseBounces(*fields.text("bounces"));
}

OptionsRequest parseOptions(Fields& fields) {
    OptionsRequest request;
    Wanted& wanted = request.wanted;
    wanted.estimator = fields.text("estimator");
    if (wanted.estimator) findEstimator(*wanted.estimator);
    wanted.rays = {wholeNumber(fields, "spp", 0, kMostCameraRays),
                   wholeNumber(fields, "camera-rays", 1, kMostCameraRays),
                   wholeNumber(fields, "samples", 0, kMostSamples),
                   fields.flag("preview").value_or(false), fields.number("target-error")};
    if (wanted.rays.targetError &&
        (wanted.rays.spp || wanted.rays.cameraRays || wanted.rays.preview))
        throw Error("options: expected target-error, or spp, camera-rays or preview, not both");
    if (wanted.rays.spp && (wanted.rays.cameraRays || wanted.rays.samples))
        throw Error("options: expected spp, or camera-rays and samples, not both");
    wanted.bounces = bouncesOf(fields);
    wanted.aovs = fields.texts("aov").value_or(std::vector<std::string>{});
    channels({}, wanted.aovs);  // knows their names
    RenderOptions& options = wanted.options;
    options.passRays =
        wholeNumber(fields, "pass-rays", 1, kMostCameraRays).value_or(options.passRays);
    options.filter = fields.choice("filter", kFilters).value_or(options.filter);
    options.transparent = fields.flag("transparent").value_or(false);
    options.filterWidth = fields.number("filter-width").value_or(0);
    options.clampIndirect = static_cast<float>(fields.number("clamp-indirect").value_or(0));
    options.seed =
        static_cast<std::uint64_t>(fields.integer("seed", 0, kMostRequestNumber).value_or(1));
    if (const auto albedo = fields.numbers("albedo", {1, 3}))
        options.plain.albedo = Rgb(vectorOf(*albedo));
    if (const auto material = fields.object("material"))
        options.plain.gloss = parseMaterial(*material);
    request.sequence = fields.choice("sequence", kSequences).value_or(Sequence::sobol);
    request.estimator.cache.adaptive =
        fields.choice("budget", kBudgets).value_or(request.estimator.cache.adaptive);
    validate(options);
    return request;
}

RenderRequest parseRender(Fields& fields) {
    RenderRequest request;
    request.frame = wholeNumber(fields, "frame", kLeastInt, kMostInt).value_or(1);
    request.pixels = fields.need(fields.text("pixels"), "pixels");
    request.progressive = fields.flag("progressive").value_or(false);
    return request;
}

Command parseCommand(const std::string& name, Fields& fields, const Json& json) {
    if (name == "load") return parseLoad(fields);
    if (name == "environment") return parseEnvironment(fields);
    if (name == "camera") return parseCamera(fields, json);
    if (name == "size") return parseSize(fields);
    if (name == "region") return parseRegion(fields);
    if (name == "options") return parseOptions(fields);
    if (name == "render") return parseRender(fields);
    if (name == "stop") return StopRequest{};
    if (name == "quit") return QuitRequest{};
    static const std::vector<std::string> kNames{
        "load", "environment", "camera", "size", "region", "options", "render", "stop", "quit"};
    throw Error(fmt::format("unknown request {}{}", name, suggestion(name, kNames)));
}

Json parseJson(const std::string& line) {
    if (!isShallowJson(line)) throw Error("JSON nested deeper than 256 levels, expected fewer");
    try {
        return Json::parse(line);
    } catch (const Json::parse_error& e) {
        throw Error(fmt::format("no JSON at byte {}, expected one object a line", e.byte));
    } catch (const Json::exception&) {
        throw Error("holds a number out of range");
    }
}

}  // namespace

Request parseRequest(const std::string& line) {
    Request request;
    try {
        const Json json = parseJson(line);
        Fields fields(json, "request");
        request.number = static_cast<std::uint64_t>(
            fields.need(fields.integer("id", 0, kMostRequestNumber), "id"));
        const std::string name = fields.need(fields.text("request"), "request");
        Fields named(json, name);
        named.integer("id", 0, kMostRequestNumber);
        named.text("request");
        Command command = parseCommand(name, named, json);
        named.requireNoOthers();
        request.command = std::move(command);
    } catch (const Error& e) {
        request.error = e.what();
    }
    return request;
}

}  // namespace shadowcache
