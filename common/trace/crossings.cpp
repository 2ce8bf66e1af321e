#include "common/trace/crossings.h"

#include <algorithm>

namespace shadowcache {

namespace {

/// Panes are shown at most so many times as often as rays stop there: what sends next to no light
/// takes next to no ray.
constexpr float kMostRaise = 8;

}  // namespace

Hit chosenOf(std::span<const Crossing> crossings, const Hit& end, const CrossingChoice& choice) {
    float passed = 1, atPanes = 0;
    for (const Crossing& c : crossings) {
        if (c.isPane) atPanes += passed * c.passage.stopped;
        passed *= 1 - c.passage.stopped;
    }
    // Panes are chosen more often than rays stop there, and all else less.
    const float least = std::min(choice.leastOfPanes, kMostRaise * atPanes);
    const bool raised = atPanes < least;
    const float ofPanes = raised ? least / atPanes : 1;
    const float ofRest = raised ? (1 - least) / (1 - atPanes) : 1;
    Hit hit = end;
    hit.share = 1 / ofRest;
    Rgb tint(1, 1, 1);
    float left = choice.chance, through = 1;
    for (const Crossing& c : crossings) {
        const float raise = c.isPane ? ofPanes : ofRest;
        left -= through * c.passage.stopped * raise;
        if (left < 0) {
            hit = c.hit;
            hit.share = 1 / raise;
            break;
        }
        through *= 1 - c.passage.stopped;
        tint *= c.passage.tint;
    }
    hit.tint = tint;
    hit.covered = end.found ? 1 : 1 - passed;
    return hit;
}

}  // namespace shadowcache
