#include "render/library/lit_stage.h"

#include <algorithm>
#include <utility>

#include "common/base/error.h"
#include "render/bounces/item_looks.h"
#include "render/frame/aov_channels.h"
#include "render/frame/integrator.h"
#include "render/frame/pilot.h"
#include "render/frame/target_error.h"

namespace shadowcache {

Film Picture::film(RenderStats& stats) const {
    return render(request_, stats);
}

ProgressiveFrame Picture::film(RenderStats& stats, const ProgressiveObserver& observer) const {
    return renderProgressive(request_, stats, observer);
}

LitStage::LitStage(const Scene& scene, const ShadowCache* cache, const EstimatorEntry& estimator,
                   const LightingOptions& options, std::string cacheName)
    : scene_(scene),
      cache_(cache),
      entry_(estimator),
      options_(options),
      cacheName_(std::move(cacheName)) {
    findLamps();
    if (options.bounces == 0 || !cache) return;
    items_.emplace(*cache);
    transport_ = readTransport(*cache, *items_);
    if (!transport_) items_.reset();
    predictLamps();
}

void LitStage::updateLamps() {
    estimator_.reset();
    groupedSolve_.reset();
    radiosity_.reset();
    solve_.reset();
    findLamps();
    predictLamps();
}

void LitStage::moveLamps() {
    estimator_.reset();
    groups_.reset();
    if (light_) light_->moveLamps();
    groupLamps();
    makeEstimator();
}

/// What shines, and in which group.
void LitStage::findLamps() {
    groups_.reset();
    light_ = SetLight::of(scene_, cache_);
    if (light_ && !entry_.lit) refuseEmitters(entry_, *light_);
    groupLamps();
}

void LitStage::groupLamps() {
    if (options_.groups.empty()) return;
    groups_ = std::make_unique<LightGroups>(options_.groups, scene_.mesh(),
                                            light_ ? &light_->emitters() : nullptr);
    for (const std::string& name : groups_->names())
        if (std::ranges::find(aovNames(), name) != aovNames().end())
            throw Error("--light-groups " + name +
                        ": is the name of an AOV; expected GROUP=NAME with another one");
}

/// What it gives the cache's items.
void LitStage::predictLamps() {
    if (!transport_) return;
    ofEmitters_ = light_ ? light_->predictItems(*items_) : std::vector<Rgb>();
    // Other gains change what looks say of emission alone, of which counts of emitters know more.
    if (looks_.empty() || ofEmitters_.empty()) looks_ = looksOf(scene_, *items_, options_.plain);
    if (groups_)
        lightOfGroups_ = ofEmitters_.empty() ? emittedByGroup(scene_, *items_, looks_, *groups_)
                                             : light_->predictItems(*items_, *groups_);
}

bool LitStage::missesTransport() const {
    return options_.bounces != 0 && cache_ && !transport_;
}

bool LitStage::missesLamps() const {
    return light_ && cache_ && !light_->knowsAll();
}

std::string LitStage::note() const {
    if (missesTransport())
        return "bounces: not predicted, the cache holds no transport; unbiased, but noisier";
    if (missesLamps())
        return "lamps: the cache " + light_->unknownText() + "; unbiased, but noisier";
    return "";
}

void LitStage::requirePrediction(const RenderOptions& options) const {
    if (options.samples != 0 && !options.preview) return;
    if (missesTransport())
        throwFileError(cacheName_,
                       "holds no transport, of which a preview of bounces is made: bake "
                       "without --no-transport, or render with --bounces 0");
    if (missesLamps())
        throwFileError(
            cacheName_,
            light_->unknownText() + "; a preview is made of these counts: bake " +
                (light_->countsNone() ? "without --no-lamps" : "the set as it stands now"));
    if (light_ && light_->moves())
        throwFileError(cacheName_,
                       "does not count lamps that move, of which a preview is made: render with "
                       "rays and without --preview; with --set-frame those of the set stand still");
}

std::size_t LitStage::bounceBytes() const {
    if (!transport_) return 0;
    return items_->memoryBytes() + transport_->memoryBytes() +
           (ofEmitters_.size() + lightOfGroups_.size() * items_->size()) * sizeof(Rgb) +
           looks_.capacity() * sizeof looks_[0] + (solve_ ? solve_->memoryBytes() : 0) +
           (groupedSolve_ ? groupedSolve_->memoryBytes() : 0) +
           (radiosity_ ? radiosity_->memoryBytes() : 0);
}

void LitStage::setEnvironment(const Environment& environment) {
    estimator_.reset();
    groupedSolve_.reset();
    radiosity_.reset();
    solve_.reset();
    if (transport_) {
        solve_ = std::make_unique<BounceSolve>(*cache_, *items_, *transport_, environment, looks_,
                                               options_.bounces, ofEmitters_);
        // What a camera's points receive has bounced once less.
        radiosity_ = std::make_unique<RadiosityTree>(
            *solve_, looks_, std::max(options_.bounces - 1, kUnlimitedBounces),
            environment.luminanceWeights(), scene_.mesh().origin);
        if (groups_)
            groupedSolve_ = std::make_unique<GroupedSolve>(
                *solve_, *transport_, looks_, lightOfGroups_, environment.luminanceIntegral() > 0);
    }
    environment_ = &environment;
    makeEstimator();
}

void LitStage::makeEstimator() {
    estimator_ = entry_.make({.scene = scene_,
                              .environment = *environment_,
                              .cache = cache_,
                              .sequence = options_.sequence,
                              .solve = solve_.get(),
                              .emitters = light_ ? &light_->light() : nullptr,
                              .groups = groups_.get(),
                              .groupedSolve = groupedSolve_.get(),
                              .radiosity = radiosity_.get()},
                             options_.estimator);
}

Picture LitStage::plan(const CameraMove& camera, int frame, const RenderOptions& options,
                       RenderStats& stats, double targetError) const {
    requirePrediction(options);
    FrameRequest request{*estimator_, camera, frame, options};
    if (targetError > 0) {
        auto [planned, correction] = planForError(std::move(request), targetError, stats);
        return {std::move(planned), correction};
    }
    request.plan = planFrame(request, stats);
    return {std::move(request), 1};
}

}  // namespace shadowcache
