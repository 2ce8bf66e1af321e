#pragma once

#include <exception>

namespace shadowcache {

/// Prints "PROGRAM: message" on standard error.
///
/// @return the status to exit with: kTryAgain for Interrupted, else kFailed
int reportFailure(const char* program, const std::exception& error);

}  // namespace shadowcache
