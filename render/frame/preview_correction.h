#pragma once

#include "render/frame/correction_field.h"
#include "render/frame/film.h"
#include "render/frame/frame_request.h"

namespace shadowcache {

/// How wrong the prediction of a frame is, as a small picture of the same view tells that is
/// rendered with rays. A preview without samples is corrected by it: its mean is right then, and
/// light that the counts blur is nearer to where it belongs. Immutable, thread-safe.
/// [docs/estimator.md]
class PreviewCorrection {
public:
    /// @param frame  without samples
    /// @param stats  gets what the small picture took
    PreviewCorrection(const FrameRequest& frame, RenderStats& stats);

    /// Corrects what a film shows reflected, but for gloss.
    void correct(Film& film) const;

private:
    struct Learnt {
        CorrectionField field;
        std::vector<Rgb> groups;  ///< what the small picture shows of each light group
    };
    static Learnt learn(const FrameRequest& frame, RenderStats& stats);

    const Learnt learnt_;
};

}  // namespace shadowcache
