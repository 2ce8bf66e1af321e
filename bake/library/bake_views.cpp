#include "bake/library/bake_views.h"

#include <fmt/core.h>

#include "bake/core/cache_part.h"
#include "bake/core/default_spacing.h"
#include "bake/core/surface_count.h"
#include "bake/library/bake_set.h"
#include "bake/shot/shot_lookups.h"
#include "bake/shot/shot_spacing.h"
#include "common/base/option_checks.h"
#include "common/base/progress.h"

namespace shadowcache {

namespace {

LookupPlaces lookupsOf(const Views& views, const Scene& scene, const VoxelFrame& frame) {
    LookupPlaces all;
    Progress progress("look", views.cameras.size());
    for (const CameraMove& camera : views.cameras) {
        all.add(shadowcache::lookupsOf(camera, scene, frame, views.size).places());
        progress.add(1);
    }
    return all;
}

}  // namespace

BakeResult bakeViews(const LoadedSet& set, BakeOptions options, const Views& views,
                     bool isLevelGiven) {
    validate(options);
    requireRange("size (width)", views.size[0], 1, 65536);
    requireRange("size (height)", views.size[1], 1, 65536);
    requireRange("margin", views.margin, 0, 64);
    const bool isSpacingFree = !(options.spacing > 0);
    if (isSpacingFree) options.spacing = spacingFactor(options.quality) * chooseSpacing(set.mesh);
    VoxelFrame frame(set.mesh, options.spacing);
    VoxelSelection selection;
    selection.lookups = lookupsOf(views, set.scene, frame);
    selection.margin = views.margin;
    const double pixels = static_cast<double>(views.cameras.size()) * views.size[0] * views.size[1];
    if (isSpacingFree)
        fitToShot(set.mesh, pixels, isLevelGiven, options, frame, *selection.lookups);
    BakeResult result = bake(set.scene, options, selection);
    recordFiles(set.options, result.header);
    result.header.part = CachePart{
        countSides(result.items), countSurface(set.mesh, frame).sides,
        fmt::format("{} cameras, {}x{}", views.cameras.size(), views.size[0], views.size[1])};
    return result;
}

}  // namespace shadowcache
