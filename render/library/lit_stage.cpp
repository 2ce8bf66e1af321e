#include "render/library/lit_stage.h"

#include <utility>

#include "common/base/error.h"
#include "render/bounces/item_looks.h"
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
    if (options.bounces == 0 || !cache) return;
    items_.emplace(*cache);
    transport_ = readTransport(*cache, *items_);
    if (transport_)
        looks_ = looksOf(scene, *items_, options.plain);
    else
        items_.reset();
}

std::string LitStage::note() const {
    if (options_.bounces == 0 || !cache_ || transport_) return "";
    return "bounces: not predicted, the cache holds no transport; unbiased, but noisier";
}

void LitStage::requireTransport(const RenderOptions& options) const {
    if (!note().empty() && (options.samples == 0 || options.preview))
        throwFileError(cacheName_,
                       "holds no transport, of which a preview of bounces is made: bake "
                       "without --no-transport, or render with --bounces 0");
}

std::size_t LitStage::bounceBytes() const {
    if (!transport_) return 0;
    return items_->memoryBytes() + transport_->memoryBytes() +
           looks_.capacity() * sizeof looks_[0] + (solve_ ? solve_->memoryBytes() : 0);
}

void LitStage::setEnvironment(const Environment& environment) {
    estimator_.reset();
    solve_.reset();
    if (transport_)
        solve_ = std::make_unique<BounceSolve>(*cache_, *items_, *transport_, environment, looks_,
                                               options_.bounces);
    estimator_ = entry_.make({scene_, environment, cache_, options_.sequence, solve_.get()},
                             options_.estimator);
}

Picture LitStage::plan(const CameraMove& camera, int frame, const RenderOptions& options,
                       RenderStats& stats, double targetError) const {
    requireTransport(options);
    FrameRequest request{*estimator_, camera, frame, options};
    if (targetError > 0) {
        auto [planned, correction] = planForError(std::move(request), targetError, stats);
        return {std::move(planned), correction};
    }
    request.plan = planFrame(request, stats);
    return {std::move(request), 1};
}

}  // namespace shadowcache
