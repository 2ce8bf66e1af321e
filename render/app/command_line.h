#pragma once

#include <optional>

#include "render/library/job.h"

namespace shadowcache {

/// Reads the command line of shadowcache-render and a settings file that it names into a job.
///
/// @return the status to exit with if there is nothing left to do: help, version, wrong usage
/// @throws Error naming the option, the text and the values wanted
std::optional<int> parseArguments(int argc, char** argv, RenderJob& job);

}  // namespace shadowcache
