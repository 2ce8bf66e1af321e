#include "common/base/parallel.h"

#include <algorithm>
#include <atomic>
#include <cassert>
#include <mutex>
#include <numeric>
#include <thread>
#include <utility>
#include <vector>

#include "common/base/call_threads.h"
#include "common/base/watch.h"

#ifdef SHADOWCACHE_STD_THREADS
#include <exception>
#else
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <optional>
#endif

namespace shadowcache {
namespace {

int coreCount() {
    return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

/// Limit that setThreadCount gave, 0 for none.
std::atomic<int> threadLimit{0};

/// Limit that withThreads gave what this thread does, 0 for none.
thread_local int callLimit = 0;

/// Whether this thread runs the body of a loop.
thread_local bool inLoop = false;

/// Sets a variable until the end of a scope.
template <class T>
class Setting {
public:
    Setting(T& variable, T value) : variable_(variable), before_(std::exchange(variable, value)) {}
    ~Setting() { variable_ = before_; }
    Setting(const Setting&) = delete;
    Setting& operator=(const Setting&) = delete;

private:
    T& variable_;
    const T before_;
};

#ifdef SHADOWCACHE_STD_THREADS

/// Plain threads for the thread sanitizer, which takes the uninstrumented TBB library's work for
/// races.
void runAll(std::size_t count, const std::function<void(std::size_t)>& run) {
    std::atomic<std::size_t> next{0};
    std::mutex mutex;
    std::exception_ptr failure;
    const auto work = [&] {
        try {
            for (std::size_t i = next++; i < count; i = next++) run(i);
        } catch (...) {
            next = count;
            const std::lock_guard lock(mutex);
            if (!failure) failure = std::current_exception();
        }
    };
    {
        std::vector<std::jthread> workers;
        const std::size_t threads = std::min(static_cast<std::size_t>(threadCount()), count);
        for (std::size_t i = 1; i < threads; ++i) workers.emplace_back(work);
        work();
    }
    if (failure) std::rethrow_exception(failure);
}

void applyLimit(int) {}

void runInArena(int, const std::function<void()>& work) {
    work();
}

#else

void runAll(std::size_t count, const std::function<void(std::size_t)>& run) {
    const auto all = [&] { tbb::parallel_for(std::size_t{0}, count, run); };
    // While a loop in a loop waits for its last chunk, its thread begins none of the outer loop's.
    if (inLoop)
        tbb::this_task_arena::isolate(all);
    else
        all();
}

void applyLimit(int threads) {
    static std::mutex mutex;
    // Not destroyed at the end, where TBB may wait for ever after an allocation of its own failed.
    static auto& control = *new std::optional<tbb::global_control>;
    const std::lock_guard lock(mutex);
    control.reset();  // first: of several controls TBB takes the smallest
    if (threads > 0)
        control.emplace(tbb::global_control::max_allowed_parallelism,
                        static_cast<std::size_t>(threads));
}

void runInArena(int threads, const std::function<void()>& work) {
    tbb::task_arena(threads).execute(work);
}

#endif

}  // namespace

void setThreadCount(int threads) {
    threadLimit = std::max(0, threads);
    applyLimit(threadLimit);
}

int threadCount() {
    int count = coreCount();
    for (const int limit : {threadLimit.load(), callLimit})
        if (limit > 0) count = std::min(count, limit);
    return count;
}

void withThreads(int threads, const std::function<void()>& work) {
    if (threads <= 0) {
        work();
        return;
    }
    const Setting limit(callLimit, threads);
    runInArena(threadCount(), work);
}

void parallelFor(std::size_t count, std::size_t chunkSize,
                 const std::function<void(const Chunk&)>& body) {
    assert(chunkSize > 0);
    const std::size_t chunks = count / chunkSize + (count % chunkSize != 0 ? 1 : 0);
    Watch* watch = currentWatch();
    const int limit = callLimit;
    runAll(chunks, [&](std::size_t index) {
        const WatchScope scope(watch);
        const Setting ofCall(callLimit, limit);
        const Setting ofLoop(inLoop, true);
        throwIfStopped();
        const std::size_t begin = index * chunkSize;
        body({begin, std::min(begin + chunkSize, count), index});
    });
}

double parallelSum(std::size_t count, std::size_t chunkSize,
                   const std::function<double(const Chunk&)>& body) {
    assert(chunkSize > 0);
    std::vector<double> parts(count / chunkSize + (count % chunkSize != 0 ? 1 : 0));
    parallelFor(count, chunkSize, [&](const Chunk& chunk) { parts[chunk.index] = body(chunk); });
    return std::accumulate(parts.begin(), parts.end(), 0.0);
}

}  // namespace shadowcache
