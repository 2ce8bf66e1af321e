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

std::vector<double> numbers(const std::filesystem::path& path, const Json& frame, const char* name,
                            std::vector<double> fallback) {
    const auto found = frame.find(name);
    if (found == frame.end()) return fallback;
    std::vector<double> values;
    if (found->is_array())
        for (const Json& value : *found)
            if (value.is_number()) values.push_back(value.get<double>());
    const bool finite =
        std::all_of(values.begin(), values.end(), [](double x) { return std::isfinite(x); });
    if (values.size() != fallback.size() || !found->is_array() ||
        found->size() != fallback.size() || !finite)
        throwFileError(path,
                       fmt::format("{} is not a list of {} finite numbers", name, fallback.size()));
    return values;
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
    std::vector<Affine> track;
    const std::vector<std::string> known{"translation", "rotation", "scale"};
    for (const Json& frame : *frames) {
        if (!frame.is_object())
            throwFileError(path, fmt::format("frame {} is not an object", track.size() + 1));
        const std::string unknown =
            unknownKey(frame, fmt::format("frames[{}]", track.size()), known);
        if (!unknown.empty()) throwFileError(path, "has the " + unknown);
        const auto t = numbers(path, frame, "translation", {0, 0, 0});
        const auto q = numbers(path, frame, "rotation", {0, 0, 0, 1});
        const auto s = numbers(path, frame, "scale", {1, 1, 1});
        track.push_back(
            fromParts({t[0], t[1], t[2]}, {q[0], q[1], q[2], q[3]}, {s[0], s[1], s[2]}));
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
