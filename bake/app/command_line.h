#pragma once

#include <optional>

#include "bake/app/job.h"

namespace shadowcache {

/// Reads the command line of shadowcache-bake.
///
/// @return the status to exit with if there is nothing left to do
/// @throws Error naming the option, the text and the form wanted
std::optional<int> parseArguments(int argc, char** argv, BakeJob& job);

}  // namespace shadowcache
