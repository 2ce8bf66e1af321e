#include "render/serve/session.h"

#include <fmt/core.h>

#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "common/base/error.h"
#include "common/base/process.h"
#include "common/base/progress.h"
#include "common/base/watch.h"
#include "common/shot/picture_view.h"
#include "render/frame/aov_channels.h"
#include "render/serve/pixel_file.h"

namespace shadowcache {

namespace {

template <class... Cases>
struct Overloaded : Cases... {
    using Cases::operator()...;
};
template <class... Cases>
Overloaded(Cases...) -> Overloaded<Cases...>;  // clang 14 does not find it by itself

PixelHeader headerOf(std::uint64_t number, const Film& film) {
    const auto whole = [](int value) { return static_cast<std::uint32_t>(value); };
    PixelHeader header;
    header.width = whole(film.width);
    header.height = whole(film.height);
    header.x = whole(film.x);
    header.y = whole(film.y);
    header.frameWidth = whole(film.frameWidth);
    header.frameHeight = whole(film.frameHeight);
    header.request = number;
    return header;
}

/// Of a picture that is in a file of pixels.
Session::Reply shown(const Film& film, const std::vector<Channel>& planes,
                     const std::filesystem::path& file, std::uint64_t sequence) {
    Session::Reply names = Session::Reply::array();
    for (const Channel& plane : planes) names.push_back(plane.name);
    return {{"pixels", file.string()}, {"sequence", sequence}, {"width", film.width},
            {"height", film.height},   {"x", film.x},          {"y", film.y},
            {"planes", names}};
}

}  // namespace

Session::Session(Log log, OnPicture onPicture)
    : log_(std::move(log)),
      onPicture_(std::move(onPicture)),
      light_([this](const std::string& text, NoteKind) { log_("map: " + text); }) {}

Session::~Session() = default;

Session::Reply Session::run(std::uint64_t number, const Command& command) {
    const auto keep = [](auto& mine, const auto& given) {
        mine = given;
        return Reply::object();
    };
    return std::visit(
        Overloaded{[&](const LoadRequest& request) { return load(request); },
                   [&](const LampsRequest& request) { return dim(request); },
                   [&](const EnvironmentRequest& request) { return light(request); },
                   [&](const CameraRequest& request) { return see(request); },
                   [&](const SizeRequest& request) { return keep(size_, request); },
                   [&](const RegionRequest& request) { return keep(region_, request); },
                   [&](const OptionsRequest& request) { return keep(options_, request); },
                   [&](const RenderRequest& request) { return render(number, request); },
                   [](const StopRequest&) { return Reply::object(); },
                   [](const QuitRequest&) { return Reply::object(); }},
        command);
}

Session::Reply Session::load(const LoadRequest& request) {
    lit_.reset();
    if (camerasOfSet_) cameras_.reset();
    stage_.reset();  // first: both may not fit into memory
    stageOptions_ = request.stage;
    stage_.emplace(request.stage, [this](const std::string& text, NoteKind) { log_(text); });
    Progress progress("load", Stage::kSteps);
    try {
        stage_->load([&] {
            progress.add(1);
            throwIfStopped();
        });
    } catch (...) {
        stage_.reset();
        throw;
    }
    return {{"triangles", stage_->mesh().report.placed},
            {"cached", stage_->cache() != nullptr},
            {"stale", stage_->isStale()}};
}

Session::Reply Session::dim(const LampsRequest& request) {
    if (!stage_) throw Error("lamps: no set, expected the request load before");
    stage_->setGains(request.gains);
    isLit_ = false;
    isDimmed_ = true;
    return Reply::object();
}

Session::Reply Session::light(const EnvironmentRequest& request) {
    const bool wasLit = std::exchange(isLit_, false);
    const bool changed = light_.load(request.light);
    isLit_ = wasLit && !changed;
    return Reply::object();
}

Session::Reply Session::see(const CameraRequest& request) {
    if (const auto* stated = std::get_if<Camera>(&request.camera)) {
        camera_ = *stated;
        cameras_.reset();
        return Reply::object();
    }
    const auto& named = std::get<CameraOptions>(request.camera);
    if (!stage_ && !named.isFile())
        throw Error(fmt::format("camera: {} is a set's camera, expected load before", named.name));
    CameraSource found = stage_ ? stage_->cameras(named) : CameraSource(named, {});
    cameras_.emplace(std::move(found));
    camerasOfSet_ = !named.isFile();
    return Reply::object();
}

CameraMove Session::cameraAt(int frame) const {
    if (cameras_) return cameras_->moveAt(frame);
    if (!camera_) throw Error("render: no camera, expected the request camera before");
    return *camera_;
}

/// Once, whatever number of pictures is of it.
void Session::noteAspect(const Camera& camera) {
    const std::string note = aspectNote(camera, size_.width, size_.height);
    if (!note.empty() && note != aspectNote_) log_("camera: " + note);
    aspectNote_ = note;
}

void Session::makeLit(const PictureSettings& settings) {
    const LightingOptions wanted = lightingOf(options_.picture, settings);
    if (!lit_ || &lit_->entry() != &settings.estimator || !isSame(lit_->options(), wanted)) {
        isLit_ = false;
        lit_.reset();
        lit_.emplace(stage_->scene(), stage_->cache(), settings.estimator, wanted,
                     stageOptions_.cache.string());
        if (!lit_->note().empty()) log_(lit_->note());
    } else if (isDimmed_) {
        lit_->updateLamps();
    }
    isDimmed_ = false;
    lit_->requirePrediction(settings.options);
    if (!isLit_) lit_->setEnvironment(light_.environment());
    isLit_ = true;
    if (std::exchange(hasMoved_, false)) lit_->moveLamps();
}

Session::Reply Session::render(std::uint64_t number, const RenderRequest& request) {
    if (!stage_) throw Error("render: no set, expected the request load before");
    if (!light_.isLoaded())
        throw Error("render: no environment, expected the request environment before");
    PictureOptions asked = options_.picture;
    asked.options.width = size_.width;
    asked.options.height = size_.height;
    asked.options.crop = region_.region;
    const PictureSettings settings =
        resolve(asked, stage_->cache() != nullptr, stageOptions_.set.mesh.gloss);
    const CameraMove camera = cameraAt(request.frame);
    noteAspect(camera.middle());
    PixelFile pixels(request.pixels);
    if (pixels.isNew()) pixelFiles_.insert(request.pixels);
    const double start = secondsNow();
    if (stage_->pose(request.frame)) hasMoved_ = true;
    makeLit(settings);
    const double lit = secondsNow();
    const auto show = [&](const Film& film) {
        const std::vector<Channel> planes = channels(film, asked.aovs);
        return shown(film, planes, request.pixels, pixels.write(headerOf(number, film), planes));
    };
    RenderStats stats;
    Film film;
    const Picture picture = lit_->plan(camera, request.frame, settings.options, stats,
                                       asked.rays.targetError.value_or(0));
    if (request.progressive) {
        ProgressiveObserver observer;
        observer.onPass = [&](const Film& pass, int rays) {
            Reply reply = show(pass);
            reply["rays"] = rays;
            onPicture_(number, reply);
        };
        ProgressiveFrame frame = picture.film(stats, observer);
        throwIfStopped();
        film = std::move(frame.film);
    } else {
        film = picture.film(stats);
    }
    Reply reply = show(film);
    reply["estimator"] = settings.estimator.name;
    reply["bias"] = biasOf(settings);
    reply["seconds"] = {{"light", lit - start}, {"render", secondsNow() - lit}};
    reply["camera-rays"] = stats.cameraRays + stats.spreadRays + stats.emissionRays;
    reply["shadow-rays"] = stats.shadowRays;
    return reply;
}

void Session::removePixels() noexcept {
    std::error_code ignored;
    for (const auto& path : pixelFiles_) std::filesystem::remove(path, ignored);
}

}  // namespace shadowcache
