#pragma once

#include "render/library/job.h"

namespace shadowcache {

/// Makes the picture of other gains out of one that has light groups, and writes it with its
/// groups. Other channels than those and the alpha are left out: most depend on the light.
///
/// @throws Error naming the picture, what it lacks, and the groups that it has
void mixGroups(const RenderJob& job);

}  // namespace shadowcache
