#include "bake/app/bake_task.h"

#include <fmt/core.h>

#include <utility>

#include "bake/core/baker.h"
#include "bake/core/default_spacing.h"
#include "bake/core/emitter_match.h"
#include "bake/shot/shot_spacing.h"
#include "common/base/error.h"
#include "common/base/number_text.h"

namespace shadowcache {

namespace {

/// Chooses the spacing if the command line does not: that of the lookups, of the cache that is
/// added to, or one for the set's size.
///
/// @param count  receives the set's surface in voxels if it was counted
BakeOptions optionsOf(const BakeJob& job, const TriangleMesh& mesh,
                      const std::optional<ShotLookups>& found, std::optional<SurfaceCount>& count) {
    BakeOptions options = job.bake;
    if (found) {
        if (options.spacing > 0 && options.spacing != found->spacing)
            throwFileError(job.lookups,
                           fmt::format("spacing {}, expected {}", numberText(found->spacing),
                                       numberText(options.spacing)));
        options.spacing = found->spacing;
        if (!job.isLevelGiven) options.level = found->level;
        count = found->ofSet;
    }
    if (!job.extend.empty() && !job.isLevelGiven) options.level = readHeader(job.extend).level;
    if (options.spacing > 0) return options;
    if (!job.extend.empty() && !job.chosenSpacings) {
        options.spacing = readHeader(job.extend).spacing;
        return options;
    }
    const double times = job.chosenSpacings.value_or(spacingFactor(options.quality));
    options.spacing = times * chooseSpacing(mesh, &count.emplace());
    if (times != 1) count.reset();
    return options;
}

}  // namespace

bool isSpacingFree(const BakeJob& job) {
    return !(job.bake.spacing > 0) && !job.chosenSpacings && job.extend.empty() &&
           job.lookups.empty();
}

BakeTask::BakeTask(const BakeJob& job, const std::optional<ShotSource>& shot, Scene& scene,
                   std::optional<ShotLookups>& found)
    : options(optionsOf(job, scene.mesh(), found, count)), frame(scene.mesh(), options.spacing) {
    if (!job.extend.empty() && !job.lookupsOnly) {
        old = readCacheToExtend(job.extend, headerOf(scene.mesh(), options),
                                emitterLabels(scene.mesh(), options));
        selection.present = VoxelSides(frame, old->items);
    }
    if (shot) {
        selection.lookups = found ? std::move(found->places) : shot->lookups(scene, frame);
        selection.margin = job.shot.margin;
        if (isSpacingFree(job) && fitToShot(scene.mesh(), static_cast<double>(shot->pixels()),
                                            job.isLevelGiven, options, frame, *selection.lookups))
            count.reset();
    }
}

SurfaceCount BakeTask::countOfSet(const TriangleMesh& mesh) const {
    return count ? *count : countSurface(mesh, frame);
}

}  // namespace shadowcache
