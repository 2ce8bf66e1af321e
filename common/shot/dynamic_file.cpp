#include "common/shot/dynamic_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/base/error.h"
#include "common/base/file_bytes.h"
#include "common/base/json_depth.h"
#include "common/base/json_keys.h"
#include "common/import/load_mesh.h"

namespace shadowcache {

namespace {

using Json = nlohmann::json;

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& key,
                         const Json& value, const std::string& wanted) {
    constexpr std::size_t kMostBytes = 60;
    const std::string found = value.dump(-1, ' ', true, Json::error_handler_t::replace);
    throwFileError(path, key + " is " + found.substr(0, kMostBytes) + ", expected " + wanted);
}

/// The numbers of a frame's key.
///
/// @param where  of the frame, as "frames[3]"
std::vector<double> numbers(const std::filesystem::path& path, const Json& frame,
                            const std::string& where, const char* name,
                            std::vector<double> fallback) {
    const auto found = frame.find(name);
    if (found == frame.end()) return fallback;
    const bool fits = found->is_array() && found->size() == fallback.size() &&
                      std::ranges::all_of(*found, [](const Json& value) {
                          return value.is_number() && std::isfinite(value.get<double>());
                      });
    if (!fits)
        refuse(path, where + "." + name, *found,
               fmt::format("a list of {} finite numbers", fallback.size()));
    return found->get<std::vector<double>>();
}

Affine transformOf(const std::filesystem::path& path, const Json& frame, const std::string& where) {
    const std::vector<std::string> known{"translation", "rotation", "scale"};
    const std::string unknown = unknownKey(frame, where, known);
    if (!unknown.empty()) throwFileError(path, "has the " + unknown);
    const auto t = numbers(path, frame, where, "translation", {0, 0, 0});
    const auto q = numbers(path, frame, where, "rotation", {0, 0, 0, 1});
    const auto s = numbers(path, frame, where, "scale", {1, 1, 1});
    if (std::ranges::all_of(q, [](double x) { return x == 0; }))
        refuse(path, where + ".rotation", frame["rotation"], "a quaternion that is not 0");
    return fromParts({t[0], t[1], t[2]}, {q[0], q[1], q[2], q[3]}, {s[0], s[1], s[2]});
}

}  // namespace

DynamicFile parseDynamic(const std::string& text) {
    // A file may have an @ in its name; a track's name ends in .json.
    const std::size_t at = text.rfind('@');
    if (at == std::string::npos || !text.ends_with(".json")) return {text, {}};
    return {text.substr(0, at), text.substr(at + 1)};
}

std::vector<Affine> readTransformTrack(const std::filesystem::path& path) {
    const std::string text = readFileBytes(path);
    if (!isShallowJson(text))
        throwFileError(path, "JSON nested deeper than 256 levels, expected fewer");
    const Json json = Json::parse(text, nullptr, false);
    if (json.is_discarded()) throwFileError(path, "is not JSON, expected a track of transforms");
    const auto frames = json.is_object() ? json.find("frames") : json.end();
    if (!json.is_object() || frames == json.end() || !frames->is_array() || frames->empty())
        throwFileError(path, "has no list of frames, expected {\"frames\": [...]}");
    const std::string unknown = unknownKey(json, "", std::vector<std::string>{"frames"});
    if (!unknown.empty()) throwFileError(path, "has the " + unknown);
    std::vector<Affine> track;
    for (const Json& frame : *frames) {
        if (!frame.is_object())
            throwFileError(path, fmt::format("frame {} is not an object", track.size() + 1));
        track.push_back(transformOf(path, frame, fmt::format("frames[{}]", track.size())));
    }
    return track;
}

DynamicObject::DynamicObject(DynamicFile dynamic, const MeshOptions& options, double fps)
    : file(std::move(dynamic)) {
    if (isGltf(file.mesh)) shot = std::make_unique<GltfShot>(file.mesh, options, fps);
    if (!file.track.empty()) track_ = readTransformTrack(file.track);
}

std::optional<Affine> DynamicObject::trackAt(int frame) const {
    if (track_.empty()) return {};
    if (frame < 1 || static_cast<std::size_t>(frame) > track_.size())
        throwFileError(file.track, fmt::format("frame {}, expected 1 to {}", frame, track_.size()));
    return track_[static_cast<std::size_t>(frame - 1)];
}

std::vector<DynamicObject> openDynamic(std::span<const DynamicFile> files,
                                       const MeshOptions& options, double fps) {
    std::vector<DynamicObject> objects;
    for (const DynamicFile& file : files) objects.emplace_back(file, options, fps);
    return objects;
}

}  // namespace shadowcache
