#pragma once

#include <filesystem>
#include <string>

#include "bake/app/estimate.h"
#include "bake/app/job.h"
#include "render/library/lit_stage.h"
#include "render/library/picture_options.h"

namespace shadowcache {

/// What a bake is worth to the pictures of a shot.
struct BakeWorth {
    BakeEstimate bake;
    double frameSeconds = 0;    ///< of a frame with the cache
    double withoutSeconds = 0;  ///< of one of the same noise without a cache

    /// Of a frame; below 0 where a cache costs more than it saves.
    double savedSeconds() const { return withoutSeconds - frameSeconds; }
};

/// What is seen, and by which light.
struct WorthView {
    const Scene& scene;  ///< with what moves where it is in the frame
    const Environment& environment;
    const CameraMove& camera;
    int frame;
    const PictureOptions& asked;  ///< unbiased
};

/// Estimates what a bake takes, from a sample of its voxels, and what it saves, from a thumbnail of
/// a frame with a bake of its own and without.
///
/// @param bake  of the shot; spacing and level are chosen by it
/// @param mesh  of the bake's set
/// @throws Error
BakeWorth worthOfBake(const BakeJob& bake, const TriangleMesh& mesh, const WorthView& view);

/// In lines for --explain: seconds, from which frame on the bake pays, and whether it does.
///
/// @param frames  of the shot
std::string textOf(const BakeWorth& worth, int frames);

/// Writes its seconds as JSON, for --stats. @throws Error
void writeWorth(const BakeWorth& worth, const std::filesystem::path& path);

}  // namespace shadowcache
