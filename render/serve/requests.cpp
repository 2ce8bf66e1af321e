#include "render/serve/requests.h"

#include <fmt/core.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/base/error.h"
#include "common/base/json_depth.h"
#include "common/base/number_text.h"
#include "common/base/suggestion.h"
#include "common/shot/camera_json.h"
#include "render/library/option_table.h"
#include "render/serve/fields.h"

namespace shadowcache {

namespace {

using Json = nlohmann::json;

constexpr int kMostInt = std::numeric_limits<int>::max();
constexpr int kLeastInt = std::numeric_limits<int>::min();

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
    RenderJob job;
    fields.need(fields.texts("set"), "set");
    fields.read(optionRows(Part::set, job));
    fields.read(optionRows(Part::cache, job));
    if (job.stage.set.files.empty()) fields.refuse("set", "a file at least");
    meshOptionsOf(job.stage.set);
    return {job.stage};
}

LampsRequest parseLamps(Fields& fields) {
    RenderJob job;
    fields.need(fields.texts("lamp"), "lamp");
    std::vector<OptionRow> rows = optionRows(Part::set, job);
    std::erase_if(rows, [](const OptionRow& row) { return row.name != "lamp"; });
    fields.read(rows);
    return {job.stage.set.mesh.gains};
}

EnvironmentRequest parseEnvironment(Fields& fields) {
    const auto map = fields.text("map");
    const auto radiance = fields.numbers("radiance", {1, 3});
    if (map.has_value() == radiance.has_value())
        throw Error("environment: expected map or radiance, one of them");
    if (map && parseRadiance(*map)) fields.refuse("map", "a file");
    RenderJob job;
    fields.read(optionRows(Part::light, job));
    const Vec3d constant = radiance ? vectorOf(*radiance) : Vec3d(0.0);
    const std::string environment = map ? *map : textOf({constant.x, constant.y, constant.z});
    if (radiance) parseRadiance(environment);
    return {{environment, parseRotation(job.light.rotation).first, gainOf(job.light.gain)}};
}

CameraRequest parseCamera(Fields& fields, const Json& json) {
    RenderJob job;
    fields.read(optionRows(Part::camera, job));
    if (job.camera.eye) return {CameraSource(job.camera, {}).at(1)};
    if (!job.camera.name.empty()) return {job.camera};
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

OptionsRequest parseOptions(Fields& fields) {
    RenderJob job;
    fields.read(optionRows(Part::picture, job));
    return {job.picture};
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
    if (name == "lamps") return parseLamps(fields);
    if (name == "environment") return parseEnvironment(fields);
    if (name == "camera") return parseCamera(fields, json);
    if (name == "size") return parseSize(fields);
    if (name == "region") return parseRegion(fields);
    if (name == "options") return parseOptions(fields);
    if (name == "render") return parseRender(fields);
    if (name == "stop") return StopRequest{};
    if (name == "quit") return QuitRequest{};
    static const std::vector<std::string> kNames{"load", "lamps",  "environment", "camera",
                                                 "size", "region", "options",     "render",
                                                 "stop", "quit"};
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
        request.error = inWordsOf(Door::serve, e.what());
    }
    return request;
}

}  // namespace shadowcache
