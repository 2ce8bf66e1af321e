#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <set>
#include <string>

#include "render/library/lit_stage.h"
#include "render/library/stage.h"
#include "render/serve/requests.h"
#include "render/shot/environment_loader.h"

namespace shadowcache {

/// What a client of the server has set up, and renders. A request keeps all that it does not
/// replace: another camera, size or region makes nothing anew, another environment or turn only
/// what light is made of.
class Session {
public:
    using Reply = nlohmann::ordered_json;
    using Log = std::function<void(const std::string&)>;
    using OnPicture = std::function<void(std::uint64_t number, const Reply&)>;

    /// @param log      has lines for people
    /// @param onPicture  is told of each pass of a progressive picture but the last
    Session(Log log, OnPicture onPicture);
    ~Session();

    /// Does what a request asks for, and tells what came of it; nothing for stop and quit.
    ///
    /// @param number  of the request
    /// @throws Error, Interrupted, std::bad_alloc; what was loaded for this request is then gone,
    /// all else as it was
    Reply run(std::uint64_t number, const Command& command);

    /// Removes the files of pixels.
    void removePixels() noexcept;

private:
    Reply load(const LoadRequest& request);
    Reply dim(const LampsRequest& request);
    Reply light(const EnvironmentRequest& request);
    Reply see(const CameraRequest& request);
    Reply render(std::uint64_t number, const RenderRequest& request);
    CameraMove cameraAt(int frame) const;
    void noteAspect(const Camera& camera);
    void makeLit(const PictureSettings& settings);

    Log log_;
    OnPicture onPicture_;
    StageOptions stageOptions_;
    std::optional<Stage> stage_;
    EnvironmentLoader light_;
    std::optional<Camera> camera_;
    std::optional<CameraSource> cameras_;  ///< in place of camera_
    bool camerasOfSet_ = false;            ///< they go with stage_
    SizeRequest size_{960, 540};
    std::string aspectNote_;  ///< of the last picture
    RegionRequest region_;
    OptionsRequest options_;
    std::optional<LitStage> lit_;
    bool isLit_ = false;     ///< lit_, by light_
    bool isDimmed_ = false;  ///< lit_ has yet to learn of other gains
    bool hasMoved_ = false;  ///< lit_ has yet to learn of lamps elsewhere
    std::set<std::filesystem::path> pixelFiles_;
};

}  // namespace shadowcache
