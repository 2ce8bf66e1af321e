#pragma once

#include <cstddef>
#include <functional>

namespace shadowcache {

/// Half-open range of indices that one call of a parallel loop's body handles.
struct Chunk {
    std::size_t begin;
    std::size_t end;
    std::size_t index;  ///< begin / chunkSize: where the chunk stands, whichever thread runs it
};

/// Limits all later parallel loops to `threads` threads; 0 means every core.
void setThreadCount(int threads);

/// Threads that a parallel loop uses now, at least 1.
int threadCount();

/// Calls `body` once for every chunk of [0, count), chunks of `chunkSize` (> 0) indices, on several
/// threads in no stated order. Chunks depend on the sizes only, never on the number of threads, so
/// a result written by chunk index has the same bits for any thread count. An exception of a body
/// stops the loop and is rethrown here. Who watches the caller watches the bodies, and may stop the
/// loop between two chunks (watch.h).
void parallelFor(std::size_t count, std::size_t chunkSize,
                 const std::function<void(const Chunk&)>& body);

/// Sum of `body` over the chunks of [0, count), added in the order of the chunks.
double parallelSum(std::size_t count, std::size_t chunkSize,
                   const std::function<double(const Chunk&)>& body);

}  // namespace shadowcache
