#include "common/shot/camera.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "common/base/error.h"
#include "common/base/file_bytes.h"
#include "common/base/json_depth.h"
#include "common/math/limits.h"
#include "common/shot/camera_json.h"

namespace shadowcache {

namespace {

using Json = nlohmann::json;

/// Sine of the least angle between the view and `up`; below it, rounding would choose the roll.
constexpr double kLeastUpSine = 1e-6;

constexpr std::size_t kQuotedLength = 60;

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

    Vec3d vector(const std::string& name) const {
        const Value value = at(name);
        const std::string wanted = "three finite numbers";
        if (!value.json.is_array() || value.json.size() != 3) value.fail(wanted);
        Vec3d result;
        for (int i = 0; i < 3; ++i) {
            const Json& element = value.json[static_cast<std::size_t>(i)];
            if (!element.is_number()) value.fail(wanted);
            result[i] = element.get<double>();
            if (!std::isfinite(result[i])) value.fail(wanted);
        }
        return result;
    }
};

/// Length that neither overflows nor underflows for any finite vector.
Vec3d unit(const Vec3d& v) {
    const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
    return largest > 0.0 ? (v / largest).normalized() : Vec3d(0.0);
}

/// Unit vector at right angles to `forward` on the side of `up`; zero if there is none.
Vec3d uprightOf(const Vec3d& forward, const Vec3d& up) {
    const Vec3d right = forward.cross(unit(up));
    return right.length() > kLeastUpSine ? right.normalized().cross(forward).normalized()
                                         : Vec3d(0.0);
}

std::string reachText() {
    return fmt::format("{:g}", kMostCoordinate);
}

std::string placeText(const Vec3d& p) {
    return fmt::format("{:g},{:g},{:g}", p.x, p.y, p.z);
}

Camera parseFrame(const Value& frame, double fovY) {
    Camera camera;
    camera.fovY = fovY;
    camera.origin = frame.vector("origin");
    if (!isInReach(camera.origin)) frame.at("origin").fail("numbers up to " + reachText());
    camera.forward = unit(frame.vector("forward"));
    if (camera.forward == Vec3d(0.0)) frame.at("forward").fail("a vector that is not zero");
    camera.up = uprightOf(camera.forward, frame.vector("up"));
    if (camera.up == Vec3d(0.0)) frame.at("up").fail("a vector not along forward");
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

}  // namespace

Camera lookAt(const Vec3d& eye, const Vec3d& target, const Vec3d& up, double fovY) {
    if (!(fovY > 0.0 && fovY < kPi)) {
        throw Error(fmt::format("angle of view {:f}, expected one in (0, pi)", fovY));
    }
    for (const Vec3d& place : {eye, target})
        if (!isInReach(place))
            throw Error("camera or its target at " + placeText(place) +
                        ", expected coordinates up to " + reachText());
    Camera camera;
    camera.fovY = fovY;
    camera.origin = eye;
    camera.forward = unit(target - eye);
    if (!(camera.forward.length2() > 0.5)) {
        throw Error("camera and target coincide, expected two places");
    }
    camera.up = uprightOf(camera.forward, up);
    if (camera.up == Vec3d(0.0)) throw Error("camera looks along its up vector");
    return camera;
}

CameraRays::CameraRays(const Camera& camera, double aspect) noexcept
    : camera_(camera),
      aspect_(aspect),
      tangent_(std::tan(0.5 * camera.fovY)),
      right_(camera.forward.cross(camera.up)) {}

Vec3d CameraRays::start(const FilmPosition& at) const noexcept {
    return camera_.origin + right_ * ((at.x - 0.5) * aspect_ * camera_.height) +
           camera_.up * ((0.5 - at.y) * camera_.height);
}

Vec3d CameraRays::direction(const FilmPosition& at) const noexcept {
    if (camera_.height > 0) return camera_.forward;
    return (camera_.forward + right_ * ((2.0 * at.x - 1.0) * aspect_ * tangent_) +
            camera_.up * ((1.0 - 2.0 * at.y) * tangent_))
        .normalized();
}

Camera cameraOf(const Json& json, const std::string& name) {
    const std::filesystem::path where = name;
    const Value frame{where, "", json};
    if (!json.is_object()) throwFileError(where, "holds no JSON object, expected a camera");
    static constexpr std::array kKnown{"origin", "forward", "up", "yfov", "height"};
    for (const auto& item : json.items())
        if (std::ranges::find(kKnown, item.key()) == kKnown.end())
            throwFileError(where, "has the unknown key " + item.key());
    if (!json.contains("height"))
        return parseFrame(frame, frame.number("yfov", 0.0, kPi, "radians in (0, pi)"));
    if (json.contains("yfov")) frame.at("height").fail("yfov or height, not both");
    Camera camera = parseFrame(frame, 1.0);
    camera.height = frame.number("height", 0.0, kMostViewHeight,
                                 fmt::format("metres in (0, {:g})", kMostViewHeight));
    return camera;
}

CameraTrack readCameraFile(const std::filesystem::path& path) {
    const Json json = parseJson(path);
    const Value root{path, "", json};
    if (!json.is_object()) throwFileError(path, "holds no JSON object, expected a camera file");
    if (json.contains("version") && json["version"] != 1) root.at("version").fail("1");
    const Value cam = root.object("cam");

    CameraTrack track;
    track.path = path;
    track.fovY = cam.number("yfov", 0.0, kPi, "radians in (0, pi)");
    track.fps = cam.number("fps", 0.0, 1e6, "frames a second above 0");
    const Value frames = cam.at("frames");
    if (!frames.json.is_array() || frames.json.empty()) frames.fail("a list of frames");
    track.frames.reserve(frames.json.size());
    for (std::size_t i = 0; i < frames.json.size(); ++i) {
        const Value frame{path, fmt::format("cam.frames[{}]", i), frames.json[i]};
        if (!frame.json.is_object()) frame.fail("an object");
        track.frames.push_back(parseFrame(frame, track.fovY));
    }
    return track;
}

const Camera& cameraAtFrame(const CameraTrack& track, long long frame) {
    const auto count = static_cast<long long>(track.frames.size());
    if (frame < 1 || frame > count) {
        throwFileError(track.path,
                       fmt::format("frame {0} of {1}, expected 1 to {1}", frame, count));
    }
    return track.frames[static_cast<std::size_t>(frame - 1)];
}

}  // namespace shadowcache
