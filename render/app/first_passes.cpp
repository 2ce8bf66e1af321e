#include "render/app/first_passes.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <memory>

#include "common/base/interrupt.h"
#include "common/base/process.h"
#include "render/frame/aov_channels.h"
#include "render/library/lit_stage.h"

namespace shadowcache {

namespace {

/// Of the time since the first of them began, at most; the first is never waited for.
constexpr double kShareOfPasses = 0.25;

constexpr std::chrono::milliseconds kBetweenLooks{50};

/// What a pass is asked for: what the picture is, as far as this takes no cache.
PictureOptions passOptions(const PictureOptions& asked, int rays) {
    PictureOptions pass = asked;
    if (pass.estimator && findEstimator(*pass.estimator).needsCache) pass.estimator.reset();
    std::erase_if(pass.aovs, needsInsight);
    pass.rays = {};
    pass.rays.spp = rays;
    return pass;
}

}  // namespace

FirstPasses::FirstPasses(const FirstPassView& view, PartialCache& cache)
    : view_(view), cache_(cache) {
    const double start = secondsNow();
    const double seconds = showPass(1);
    thread_ = std::thread([this, start, seconds] { goOn(start, seconds); });
}

FirstPasses::~FirstPasses() {
    end();
}

std::string FirstPasses::end() {
    watch_.stop = true;
    if (thread_.joinable()) thread_.join();
    return failure_;
}

/// @param start  of the first pass
/// @param last   seconds that it took
void FirstPasses::goOn(double start, double last) try {
    double spent = last;
    for (int rays = 2; rays <= view_.mostRays; rays *= 2) {
        awaitTurn(start, spent, 2 * last);
        last = showPass(rays);
        spent += last;
    }
} catch (const Interrupted&) {
} catch (const std::exception& e) {
    failure_ = e.what();
}

/// @param next  seconds that the next pass may take
void FirstPasses::awaitTurn(double start, double spent, double next) const {
    while (spent + next > kShareOfPasses * (secondsNow() - start + next)) {
        if (mustEnd(&watch_)) throw Interrupted();
        std::this_thread::sleep_for(kBetweenLooks);
    }
}

/// @return seconds that it took
double FirstPasses::showPass(int rays) {
    const WatchScope watched(&watch_);  // the progress that is printed is the bake's
    const double start = secondsNow();
    const std::unique_ptr<ShadowCache> cache = cache_.now();
    if (knew_ && !cache) throw Interrupted();  // the bake has ended
    knew_ = cache != nullptr;
    const PictureOptions asked = passOptions(view_.asked, rays);
    const PictureSettings settings = resolve(asked, cache != nullptr);
    LitStage lit(view_.scene, cache.get(), settings.estimator, lightingOf(asked, settings));
    lit.setEnvironment(view_.environment);
    RenderStats stats;
    const Film film = lit.plan(view_.camera, view_.frame, settings.options, stats).film(stats);
    view_.show({settings, film, secondsNow() - start, cache ? cache->itemCount() : 0});
    return secondsNow() - start;
}

}  // namespace shadowcache
