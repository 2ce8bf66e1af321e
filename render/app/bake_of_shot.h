#pragma once

#include "bake/app/job.h"
#include "render/library/job.h"

namespace shadowcache {

/// The bake of a job's cache, as its command line would have it: of the set, camera, frames and
/// size of the pictures, so that the program continues what this one leaves, and the other way
/// round.
///
/// @throws Error if no bake has these options
BakeJob bakeOfShot(const RenderJob& job);

/// Refuses a cache that is there and was not baked for the frames of the job. Reads its header and
/// the files of the shot.
///
/// @param bake  of bakeOfShot()
/// @throws Error naming the cache, the shots that it has and the one wanted
void requireOfShot(const BakeJob& bake);

/// The set of a job as it stands in memory, if that has all that a bake reads; else null.
const TriangleMesh* meshForBake(const RenderJob& job, const TriangleMesh& mesh);

/// The bake of all of a job, of its set as it stands in memory where that has all that a bake
/// reads.
///
/// @param partial  gets what is finished so far; null: nobody wants it
/// @throws Error, Interrupted; then the checkpoint has what is finished
void bakeShot(const RenderJob& job, const BakeJob& bake, const TriangleMesh& mesh,
              PartialCache* partial);

}  // namespace shadowcache
