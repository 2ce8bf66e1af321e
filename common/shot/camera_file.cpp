#include "common/shot/camera_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "common/base/error.h"
#include "common/base/file_bytes.h"
#include "common/base/json_depth.h"
#include "common/base/json_keys.h"
#include "common/math/limits.h"
#include "common/shot/camera_json.h"

namespace shadowcache {

namespace {

using Json = nlohmann::json;

constexpr std::size_t kQuotedLength = 60;

/// What a camera may say for all frames and a frame for itself.
const std::vector<std::string> kLookKeys{"yfov", "height", "shift", "pixel_aspect",
                                         "near", "far",    "lens"};
const std::vector<std::string> kLensKeys{"radius", "focus", "blades", "rotation"};

std::vector<std::string> withLook(std::vector<std::string> keys) {
    keys.insert(keys.end(), kLookKeys.begin(), kLookKeys.end());
    return keys;
}

const std::vector<std::string> kPoseKeys = withLook({"origin", "forward", "up"});
/// The time of a frame says nothing that its number does not.
const std::vector<std::string> kFrameKeys = withLook({"origin", "forward", "up", "t"});
const std::vector<std::string> kCamKeys = withLook({"fps", "frames"});

/// A value of the file and where it stands ("cam.frames[3].up"), for messages.
struct Value {
    const std::filesystem::path& file;
    std::string key;
    const Json& json;

    [[noreturn]] void fail(const std::string& wanted) const {
        std::string found = json.dump(-1, ' ', true, Json::error_handler_t::replace);
        if (found.size() > kQuotedLength) found.replace(kQuotedLength, found.npos, "...");
        throwFileError(file, key + " is " + found + ", expected " + wanted);
    }

    void knowOnly(std::span<const std::string> known) const {
        const std::string unknown = unknownKey(json, key, known);
        if (!unknown.empty()) throwFileError(file, "has the " + unknown);
    }

    Value at(const std::string& name) const {
        const std::string path = key.empty() ? name : key + "." + name;
        const auto found = json.find(name);
        if (found == json.end()) throwFileError(file, "has no " + path);
        return {file, path, *found};
    }

    Value object(const std::string& name) const {
        Value value = at(name);
        if (!value.json.is_object()) value.fail("an object");
        return value;
    }

    double number(const std::string& name, double above, double below,
                  const std::string& wanted) const {
        const Value value = at(name);
        if (!value.json.is_number()) value.fail(wanted);
        const double result = value.json.get<double>();
        if (!(result > above && result < below)) value.fail(wanted);
        return result;
    }

    std::vector<double> numbers(const std::string& name, std::size_t count,
                                const std::string& wanted) const {
        const Value value = at(name);
        if (!value.json.is_array() || value.json.size() != count) value.fail(wanted);
        std::vector<double> result;
        for (const Json& element : value.json) {
            if (!element.is_number()) value.fail(wanted);
            result.push_back(element.get<double>());
            if (!std::isfinite(result.back())) value.fail(wanted);
        }
        return result;
    }

    Vec3d vector(const std::string& name) const {
        const std::vector<double> v = numbers(name, 3, "three finite numbers");
        return {v[0], v[1], v[2]};
    }
};

/// Most of a shift, a ratio and a number that are no mistake.
constexpr double kMostShift = 100, kMostPixelAspect = 100;

std::string bladesWanted() {
    return fmt::format("0, or a whole number from 3 to {}", kMostBlades);
}

/// What "cam" says for all frames and a frame for itself.
void readLook(const Value& from, Camera& camera) {
    const auto has = [&](const char* key) { return from.json.contains(key); };
    if (has("yfov") && has("height"))
        from.at("height").fail("either yfov, of a perspective camera, or height");
    if (has("yfov")) {
        camera.fovY = from.number("yfov", 0.0, kPi, "radians in (0, pi)");
        camera.height = 0;
    }
    if (has("height"))
        camera.height = from.number("height", 0.0, kMostViewHeight,
                                    fmt::format("metres in (0, {:g})", kMostViewHeight));
    if (has("shift")) {
        const std::vector<double> shift = from.numbers("shift", 2, "two finite numbers");
        for (const double s : shift)
            if (!(std::abs(s) <= kMostShift))
                from.at("shift").fail(fmt::format("numbers up to {:g}", kMostShift));
        camera.shiftX = shift[0];
        camera.shiftY = shift[1];
    }
    if (has("pixel_aspect"))
        camera.pixelAspect =
            from.number("pixel_aspect", 1 / kMostPixelAspect, kMostPixelAspect,
                        fmt::format("a ratio in (1/{0:g}, {0:g})", kMostPixelAspect));
    const double infinity = std::numeric_limits<double>::infinity();
    if (has("near")) {
        const double tiny = -std::numeric_limits<double>::denorm_min();
        camera.near = from.number("near", tiny, kMostCoordinate, "metres, 0 or more");
    }
    if (has("far")) camera.far = from.number("far", 0.0, infinity, "metres above 0");
    if (has("lens")) {
        const Value lens = from.object("lens");
        lens.knowOnly(kLensKeys);
        camera.lens.radius = lens.number("radius", -std::numeric_limits<double>::denorm_min(),
                                         kMostCoordinate, "metres, 0 or more");
        camera.lens.focus = lens.number("focus", 0.0, 1e9, "metres above 0, below 1e9");
        if (lens.json.contains("blades")) {
            const double blades = lens.number("blades", -1, kMostBlades + 1, bladesWanted());
            if (blades != std::floor(blades) || blades == 1 || blades == 2)
                lens.at("blades").fail(bladesWanted());
            camera.lens.blades = static_cast<int>(blades);
        }
        if (lens.json.contains("rotation"))
            camera.lens.rotation =
                lens.number("rotation", -infinity, infinity, "a finite number of radians");
    }
}

Camera parseFrame(const Value& frame, const Camera& common) {
    Camera camera = common;
    camera.origin = frame.vector("origin");
    if (!isInReach(camera.origin))
        frame.at("origin").fail(fmt::format("numbers up to {:g}", kMostCoordinate));
    camera.forward = unitOf(frame.vector("forward"));
    if (camera.forward == Vec3d(0.0)) frame.at("forward").fail("a vector that is not zero");
    camera.up = uprightOf(camera.forward, frame.vector("up"));
    if (camera.up == Vec3d(0.0)) frame.at("up").fail("a vector not along forward");
    readLook(frame, camera);
    if (!(camera.near < camera.far))
        throwFileError(frame.file,
                       fmt::format("{} has near {:g} and far {:g}, expected near below far",
                                   frame.key, camera.near, camera.far));
    return camera;
}

Json parseJson(const std::filesystem::path& path) {
    const std::string text = readFileBytes(path);
    if (!isShallowJson(text))
        throwFileError(path, "JSON nested deeper than 256 levels, expected fewer");
    try {
        return Json::parse(text);
    } catch (const Json::parse_error& e) {
        if (e.byte > text.size()) throwFileError(path, "truncated: the JSON text is incomplete");
        throwFileError(path, fmt::format("no JSON at byte {}, expected a camera file", e.byte));
    } catch (const Json::exception&) {
        throwFileError(path, "holds a number out of range");
    }
}

/// Whether each frame says for itself what it sees.
bool eachSees(const Json& frames) {
    return std::ranges::all_of(frames, [](const Json& frame) {
        return frame.is_object() && (frame.contains("yfov") || frame.contains("height"));
    });
}

}  // namespace

Camera cameraOf(const Json& json, const std::string& name) {
    const std::filesystem::path where = name;
    const Value frame{where, "", json};
    if (!json.is_object()) throwFileError(where, "holds no JSON object, expected a camera");
    frame.knowOnly(kPoseKeys);
    if (!json.contains("height")) frame.at("yfov");
    return parseFrame(frame, {});
}

CameraTrack readCameraFile(const std::filesystem::path& path) {
    const Json json = parseJson(path);
    const Value root{path, "", json};
    if (!json.is_object()) throwFileError(path, "holds no JSON object, expected a camera file");
    if (json.contains("version") && json["version"] != 1) root.at("version").fail("1");
    const Value cam = root.object("cam");
    cam.knowOnly(kCamKeys);

    CameraTrack track;
    track.path = path;
    track.fps = cam.number("fps", 0.0, 1e6, "frames a second above 0");
    const Value frames = cam.at("frames");
    if (!frames.json.is_array() || frames.json.empty()) frames.fail("a list of frames");
    if (!cam.json.contains("height") && !eachSees(frames.json)) cam.at("yfov");
    Camera common;
    readLook(cam, common);
    track.fovY = common.fovY;
    track.frames.reserve(frames.json.size());
    for (std::size_t i = 0; i < frames.json.size(); ++i) {
        const Value frame{path, fmt::format("cam.frames[{}]", i), frames.json[i]};
        if (!frame.json.is_object()) frame.fail("an object");
        frame.knowOnly(kFrameKeys);
        track.frames.push_back(parseFrame(frame, common));
    }
    return track;
}

}  // namespace shadowcache
