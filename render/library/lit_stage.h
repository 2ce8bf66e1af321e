#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/cache/shadow_cache.h"
#include "common/cache/transport.h"
#include "common/light/environment.h"
#include "common/predict/bounce_solve.h"
#include "common/predict/grouped_solve.h"
#include "common/predict/radiosity_tree.h"
#include "common/trace/scene.h"
#include "render/frame/film.h"
#include "render/frame/frame_request.h"
#include "render/frame/progressive.h"
#include "render/library/set_light.h"
#include "render/table/estimator_table.h"

namespace shadowcache {

/// How a stage is lit.
struct LightingOptions {
    EstimatorOptions estimator = {};          ///< of the one that is chosen
    Sequence sequence = Sequence::kSobol;     ///< of random numbers
    int bounces = 0;                          ///< as RenderOptions::bounces
    PlainLook plain = {};                     ///< as RenderOptions::plain
    std::vector<LightGroupRule> groups = {};  ///< whose light is kept apart; empty: all is one
};

/// A picture that is planned: how many rays each part gets.
class Picture {
public:
    /// Renders it. Thread-safe. @throws Error as render()
    Film film(RenderStats& stats) const;

    /// The same in passes. @throws Error as renderProgressive()
    ProgressiveFrame film(RenderStats& stats, const ProgressiveObserver& observer) const;

    /// What is rendered.
    const FrameRequest& request() const { return request_; }
    /// Of measuredError(), by the pilot.
    double errorCorrection() const { return errorCorrection_; }

private:
    friend class LitStage;
    Picture(FrameRequest request, double errorCorrection)
        : request_(std::move(request)), errorCorrection_(errorCorrection) {}

    FrameRequest request_;
    double errorCorrection_;
};

/// A set and its cache under one environment after another: what its pictures share is made once,
/// and again where the environment changes.
class LitStage {
public:
    /// @param scene      outlives the lit stage
    /// @param cache      likewise; null where the estimator needs none
    /// @param estimator  of the table
    /// @param cacheName  of the cache in messages
    /// @throws Error naming the cache's file if that cannot be read any more, or the estimator if
    /// the set shines and that is of the sky alone; --light-groups as LightGroups does, and for a
    /// name that is an AOV's
    LitStage(const Scene& scene, const ShadowCache* cache, const EstimatorEntry& estimator,
             const LightingOptions& options, std::string cacheName = "cache");

    /// What is to be known of its pictures: that bounces are not predicted for want of transport,
    /// or lamps for want of their counts, which is unbiased but noisier. Empty: nothing.
    std::string note() const;

    /// Whether something in the set emits, so that it can be seen without a sky.
    bool shines() const { return light_ != nullptr; }

    /// Refuses pictures that show light as predicted, of a cache that cannot predict it.
    /// @throws Error naming the cache
    void requirePrediction(const RenderOptions& options) const;

    /// The estimator's row of the table.
    const EstimatorEntry& entry() const { return entry_; }
    /// What it was made with.
    const LightingOptions& options() const { return options_; }

    /// Bytes of memory for what the cache knows of the light that bounces, which is held whole.
    std::size_t bounceBytes() const;

    /// Lights it by another environment. Solves the light that bounces under it, as far as the
    /// cache knows it.
    ///
    /// @param environment  stays until the next one, or as long as the lit stage
    void setEnvironment(const Environment& environment);

    /// Learns what shines in the scene's set, whose gains have changed. setEnvironment() must
    /// follow.
    ///
    /// @throws Error as the constructor
    void updateLamps();

    /// Learns where the lamps of the scene's set that move stand now, which solves nothing again.
    ///
    /// @pre setEnvironment() was called, and its environment is there
    void moveLamps();

    /// Of the environment that was set last.
    const Estimator& estimator() const { return *estimator_; }

    /// Plans a picture under the environment that was set last. Thread-safe.
    ///
    /// @param frame        its number chooses the random numbers
    /// @param options      with the bounces and the plain look of the lit stage
    /// @param targetError  relMSE that planForError() chooses the camera rays for; 0: those of
    /// `options`
    /// @throws Error as requirePrediction() and render()
    Picture plan(const CameraMove& camera, int frame, const RenderOptions& options,
                 RenderStats& stats, double targetError = 0) const;

private:
    bool missesTransport() const;
    bool missesLamps() const;
    void findLamps();
    void groupLamps();
    void predictLamps();
    void makeEstimator();

    const Scene& scene_;
    const ShadowCache* cache_;
    const EstimatorEntry& entry_;
    const LightingOptions options_;
    const std::string cacheName_;
    std::optional<ItemTable> items_;
    std::optional<Transport> transport_;
    std::unique_ptr<SetLight> light_;              ///< null: nothing shines
    std::vector<ItemLook> looks_;                  ///< by item
    std::vector<Rgb> ofEmitters_;                  ///< by item: as BounceSolve wants it
    std::unique_ptr<const LightGroups> groups_;    ///< null: none are asked for
    std::vector<std::vector<Rgb>> lightOfGroups_;  ///< by group: as GroupedSolve wants it
    std::unique_ptr<BounceSolve> solve_;
    std::unique_ptr<GroupedSolve> groupedSolve_;
    std::unique_ptr<RadiosityTree> radiosity_;  ///< of `solve_`
    const Environment* environment_ = nullptr;  ///< null: none was set
    std::unique_ptr<Estimator> estimator_;
};

}  // namespace shadowcache
