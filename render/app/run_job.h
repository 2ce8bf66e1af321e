#pragma once

#include "render/library/job.h"

namespace shadowcache {

/// Runs the job. @throws Error
void run(const RenderJob& job);

/// Prints the cameras, animations and sizes of the set's glTF files. @throws Error
void listSet(const RenderJob& job);

}  // namespace shadowcache
