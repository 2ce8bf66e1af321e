#pragma once

#include <functional>
#include <string>
#include <thread>

#include "bake/core/partial_cache.h"
#include "common/base/watch.h"
#include "common/trace/scene.h"
#include "render/frame/film.h"
#include "render/library/picture_options.h"

namespace shadowcache {

/// A picture that is shown while its cache is being baked.
struct FirstPass {
    const PictureSettings& settings;
    const Film& film;
    double seconds = 0;     ///< that it took
    std::size_t items = 0;  ///< baked, that it knew of
};

/// What the pictures show, and who sees them.
struct FirstPassView {
    const Scene& scene;  ///< with what moves where it is in the frame
    const Environment& environment;
    const CameraMove& camera;
    int frame;
    const PictureOptions& asked;                 ///< of the picture with the whole cache
    int mostRays;                                ///< camera rays a pixel that it will have
    std::function<void(const FirstPass&)> show;  ///< called by one thread after the other
};

/// Shows pictures of a frame before its cache is baked: a first one at once, of one camera ray a
/// pixel, then others of twice as many each, with what is baked by then. They are unbiased. The
/// first takes a small part of the rays of a bake; the others take at most a quarter of the time,
/// so that the bake hardly waits for them.
class FirstPasses {
public:
    /// Shows the first, and lets a thread go on.
    ///
    /// @param view  what it refers to outlives this
    /// @throws Error, Interrupted of the first
    FirstPasses(const FirstPassView& view, PartialCache& cache);
    /// Ends them, in the middle of a picture if need be.
    ~FirstPasses();
    FirstPasses(const FirstPasses&) = delete;
    FirstPasses& operator=(const FirstPasses&) = delete;

    /// Ends them. @return why there were no more of them; empty if nothing went wrong
    std::string end();

private:
    void goOn(double start, double last);
    double showPass(int rays);
    void awaitTurn(double start, double spent, double next) const;

    const FirstPassView view_;
    PartialCache& cache_;
    Watch watch_;
    bool knew_ = false;  ///< a pass has had items
    std::string failure_;
    std::thread thread_;
};

}  // namespace shadowcache
