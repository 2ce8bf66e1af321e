#include "render/library/shot.h"

#include "render/bounces/item_looks.h"
#include "render/frame/integrator.h"
#include "render/frame/pilot.h"
#include "render/frame/target_error.h"

namespace shadowcache {

Shot::Shot(const Scene& scene, const ShadowCache* cache, const EstimatorEntry& estimator,
           const ShotOptions& options)
    : scene_(scene), cache_(cache), entry_(estimator), options_(options) {
    if (options.bounces == 0 || !cache) return;
    items_.emplace(*cache);
    transport_ = readTransport(*cache, *items_);
    missesTransport_ = !transport_;
    if (transport_)
        looks_ = looksOf(scene, *items_, options.plain);
    else
        items_.reset();
}

std::size_t Shot::bounceBytes() const {
    if (!transport_) return 0;
    return items_->memoryBytes() + transport_->memoryBytes() +
           looks_.capacity() * sizeof looks_[0] + (solve_ ? solve_->memoryBytes() : 0);
}

void Shot::setEnvironment(const Environment& environment) {
    estimator_.reset();
    solve_.reset();
    if (transport_)
        solve_ = std::make_unique<BounceSolve>(*cache_, *items_, *transport_, environment, looks_,
                                               options_.bounces);
    estimator_ = entry_.make({scene_, environment, cache_, options_.sequence, solve_.get()},
                             options_.estimator);
}

Film Shot::renderFrame(const CameraMove& camera, int frameNumber, const RenderOptions& options,
                       RenderStats& stats, double targetError) const {
    return render(planned(camera, frameNumber, options, stats, targetError), stats);
}

ProgressiveFrame Shot::renderPasses(const CameraMove& camera, int frameNumber,
                                    const RenderOptions& options, RenderStats& stats,
                                    const ProgressiveObserver& observer, double targetError) const {
    return renderProgressive(planned(camera, frameNumber, options, stats, targetError), stats,
                             observer);
}

FrameRequest Shot::planned(const CameraMove& camera, int frameNumber, const RenderOptions& options,
                           RenderStats& stats, double targetError) const {
    FrameRequest frame{*estimator_, camera, frameNumber, options};
    if (targetError > 0) return planForError(frame, targetError, stats).frame;
    frame.plan = planFrame(frame, stats);
    return frame;
}

}  // namespace shadowcache
