#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "render/library/job.h"

namespace shadowcache {

// What a line of docs/serve.md asks for.

/// Loads a set and its cache in place of what was loaded before.
struct LoadRequest {
    StageOptions stage{};
};

/// Other gains of what shines in the set, in place of those it has.
struct LampsRequest {
    std::vector<LampGain> gains{};
};

struct EnvironmentRequest {
    LightPlan::Light light;
};

/// A camera that is stated, or one that a file or the set has, by frame.
struct CameraRequest {
    std::variant<Camera, CameraOptions> camera;
};

struct SizeRequest {
    int width = 0, height = 0;
};

struct RegionRequest {
    std::optional<FilmRectangle> region{};  ///< none: the whole frame
};

/// All options of pictures: those that are not named are the standard ones.
struct OptionsRequest {
    PictureOptions picture{};
};

struct RenderRequest {
    int frame = 1;
    std::filesystem::path pixels{};  ///< where they are written
    bool progressive = false;        ///< the picture is shown after each pass
};

/// Ends what runs, and what waits before it.
struct StopRequest {};

/// Ends the process once all before it is done.
struct QuitRequest {};

using Command =
    std::variant<LoadRequest, LampsRequest, EnvironmentRequest, CameraRequest, SizeRequest,
                 RegionRequest, OptionsRequest, RenderRequest, StopRequest, QuitRequest>;

/// A line, read.
struct Request {
    std::optional<std::uint64_t> number{};  ///< if the line has one
    std::optional<Command> command{};       ///< nothing: `error` says why
    std::string error{};
};

/// Numbers that a request may have: those that every JSON library reads exactly.
inline constexpr std::int64_t kMostRequestNumber = (std::int64_t{1} << 53) - 1;

/// Reads a line of any bytes. @throws std::bad_alloc only
Request parseRequest(const std::string& line);

}  // namespace shadowcache
