#pragma once

#include "common/base/watch.h"

namespace shadowcache {

/// Makes Ctrl-C and SIGTERM ask for a clean end instead of killing the process at once. A process
/// that has not ended four seconds later, since a library was at work, ends there with status
/// kTryAgain. A second signal kills it.
void installInterruptHandler();

/// @throws Interrupted once a signal, or who watches the call, has asked for the end. Cheap; long
/// loops call it often.
void throwIfInterrupted();

}  // namespace shadowcache
