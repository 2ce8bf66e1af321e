#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "common/cache/shadow_cache.h"
#include "common/cache/transport.h"
#include "common/light/environment.h"
#include "common/predict/bounce_solve.h"
#include "common/trace/scene.h"
#include "render/frame/film.h"
#include "render/frame/frame_request.h"
#include "render/frame/progressive.h"
#include "render/table/estimator_table.h"

namespace shadowcache {

/// How a shot is lit.
struct ShotOptions {
    EstimatorOptions estimator = {};      ///< of the one that is chosen
    Sequence sequence = Sequence::sobol;  ///< of random numbers
    int bounces = 0;                      ///< as RenderOptions::bounces
    PlainLook plain = {};                 ///< as RenderOptions::plain
};

/// A set and its cache under one environment after another: what its frames share is made once, and
/// again where the environment changes.
class Shot {
public:
    /// @param scene      outlives the shot
    /// @param cache      outlives the shot; null where the estimator needs none
    /// @param estimator  of the table
    /// @throws Error naming the cache's file if that cannot be read any more
    Shot(const Scene& scene, const ShadowCache* cache, const EstimatorEntry& estimator,
         const ShotOptions& options);

    /// Whether light bounces off a cached set whose cache holds no transport: it is not predicted,
    /// which is unbiased but noisier.
    bool missesTransport() const { return missesTransport_; }

    /// Bytes of memory for what the cache knows of the light that bounces, which is held whole.
    std::size_t bounceBytes() const;

    /// Lights the shot by another environment. Solves the light that bounces under it, as far as
    /// the cache knows it.
    ///
    /// @param environment  stays until the next one, or as long as the shot
    void setEnvironment(const Environment& environment);

    /// Of the environment that was set last.
    const Estimator& estimator() const { return *estimator_; }

    /// Renders a frame under the environment that was set last: its pilot first, then render().
    /// Thread-safe.
    ///
    /// @param frameNumber  chooses the random numbers
    /// @param options      with the bounces and the plain look of the shot
    /// @param targetError  relMSE that planForError() chooses the camera rays for; 0: those of
    /// `options`
    /// @throws Error as render()
    Film renderFrame(const CameraMove& camera, int frameNumber, const RenderOptions& options,
                     RenderStats& stats, double targetError = 0) const;

    /// The same in passes. @throws Error as renderProgressive()
    ProgressiveFrame renderPasses(const CameraMove& camera, int frameNumber,
                                  const RenderOptions& options, RenderStats& stats,
                                  const ProgressiveObserver& observer,
                                  double targetError = 0) const;

private:
    FrameRequest planned(const CameraMove& camera, int frameNumber, const RenderOptions& options,
                         RenderStats& stats, double targetError) const;

    const Scene& scene_;
    const ShadowCache* cache_;
    const EstimatorEntry& entry_;
    ShotOptions options_;
    bool missesTransport_ = false;
    std::optional<ItemTable> items_;
    std::optional<Transport> transport_;
    std::vector<ItemLook> looks_;  ///< by item
    std::unique_ptr<BounceSolve> solve_;
    std::unique_ptr<Estimator> estimator_;
};

}  // namespace shadowcache
