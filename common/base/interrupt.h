#pragma once

#include "common/base/watch.h"

namespace shadowcache {

/// Makes Ctrl-C and SIGTERM ask for a clean end instead of killing the process at once. A process
/// that has not ended four seconds later, since a library was at work, ends there with status
/// kTryAgain. A second signal kills it.
void installInterruptHandler();

/// Whether a signal, or who watches a call, has asked for the end.
///
/// @param watch  of the call, which may go on in threads of a library; null: nobody watches
bool mustEnd(const Watch* watch) noexcept;

/// @throws Interrupted once a signal, or who watches this thread, has asked for the end. Cheap;
/// long loops call it often.
void throwIfInterrupted();

}  // namespace shadowcache
