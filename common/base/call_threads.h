#pragma once

#include <functional>

namespace shadowcache {

/// Runs `work` on this thread, and all parallel loops that it starts on at most `threads` threads
/// (0: as many as otherwise; never more than cores). Calls at once have a number each, and results
/// have the same bits for any number.
///
/// @throws what `work` throws
void withThreads(int threads, const std::function<void()>& work);

}  // namespace shadowcache
