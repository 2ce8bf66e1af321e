#pragma once

#include <optional>

#include "render/app/arguments.h"

namespace shadowcache {

/// The options of shadowcache-render, in the groups that --help shows.
///
/// @return the status to exit with if there is nothing left to do: help, version, wrong usage
std::optional<int> parseArguments(int argc, char** argv, Arguments& arguments);

}  // namespace shadowcache
