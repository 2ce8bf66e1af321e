#pragma once

#include <exception>
#include <string>

namespace shadowcache {

/// A message as a terminal may show it: control characters, which a file's name may hold, become
/// question marks, and what is longer than 8192 bytes loses its middle.
std::string oneLine(std::string text);

/// Prints "PROGRAM: message" on standard error.
///
/// @return the status to exit with: kTryAgain for Interrupted, else kFailed
int reportFailure(const char* program, const std::exception& error) noexcept;

/// Makes an exception that nothing can catch, as of a thread that a library cannot start, end the
/// program like any other failure: one line, status kFailed. So does a file that grows beyond the
/// limit of the system's user.
void installFailureHandler() noexcept;

}  // namespace shadowcache
