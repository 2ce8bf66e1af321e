#pragma once

#include <functional>
#include <span>

#include "common/base/pool.h"
#include "render/bounces/bounce_task.h"
#include "render/bounces/path_level.h"

namespace shadowcache {

/// Light that reaches places after it left other surfaces of the set. Paths go on from all places
/// together, level by level; all vertices of a level are lit as one batch of the estimator that
/// lights the places themselves, and near vertices share what their rays meet. Everything random is
/// decided before the first ray that it could depend on. [docs/estimator.md]
class BounceLight {
public:
    /// @param estimator  of direct light
    /// @param plan       of vertices, by the estimator's pilot; may be null. Both outlive this
    /// object
    BounceLight(const Estimator& estimator, const EstimatorPlan* plan,
                const BounceOptions& options);

    /// Light that reaches each of the receivers from other surfaces.
    ///
    /// @param light    as many as receivers
    /// @param onLevel  called when the vertices of a level are lit, the costliest first
    /// @param pilot    if not null, gets what the paths tell
    /// @return the same by light group
    GroupedBounce gather(
        std::span<const BounceReceiver> receivers, std::span<BouncedLight> light,
        BounceCounts& counts, const std::function<void()>& onLevel = [] {},
        PathPilot* pilot = nullptr) const;

    /// The same as it is predicted, without rays.
    ///
    /// @param light  receives it as `predicted`; 0 without a solve
    /// @return the same by light group
    GroupedBounce predict(std::span<const BounceReceiver> receivers,
                          std::span<BouncedLight> light) const;

private:
    /// Lights the vertices of a level that have items by what is predicted to bounce to them.
    void predictLight(int bounce, PathLevel& level) const;
    /// Makes room for the light of a level's groups, if there are any.
    void addGroups(PathLevel& level) const;
    /// Notes the vertices of a level that are lit.
    void addLit(const PathLevel& level, PathPilot& pilot) const;
    /// Notes what the rays of a level found beside what was predicted.
    void comparePredicted(const PathLevel& level, std::span<const Rgb> found,
                          PredictionCheck& check) const;
    /// Adds what the rays of a level found to its light, in place of what was predicted of it.
    void addBounced(std::span<const Rgb> found, const PathLevel& next, PathLevel& level) const;
    /// The same by light group.
    void addBounced(const GroupedLight& found, const PathLevel& next, PathLevel& level) const;
    /// How the diffuse rays of a level are drawn.
    Guides guide(const PathLevel& level, int bounce, BounceCounts& counts) const;
    int bouncesLeft(int bounce) const;
    GroupSizes sizesAt(int bounce) const;
    void clampLight(std::span<const BounceReceiver> receivers, std::span<BouncedLight> light,
                    GroupedBounce& grouped) const;

    const Estimator& estimator_;
    const EstimatorPlan* plan_;
    const BounceOptions options_;
    mutable Pool<Workspace> workspaces_;
};

}  // namespace shadowcache
