#pragma once

#include <pybind11/pybind11.h>

#include <functional>
#include <optional>
#include <utility>

namespace shadowcache::python {

/// Runs `work` on a thread of its own, without the interpreter's lock, and returns when it has
/// ended: other Python threads run meanwhile. Ctrl-C, and an exception of `progress`, end it within
/// moments, as far as the library polls, and are raised.
///
/// @param progress  called with (task, done, total), on the caller's thread; None: not called
/// @param threads  that the work takes at most; 0: as many as set_threads() allows
/// @throws Error on an impossible number of threads
void runLong(const pybind11::object& progress, const std::function<void()>& work, int threads);

/// The same of what returns something.
template <class Work>
auto longCall(const pybind11::object& progress, const Work& work, int threads = 0) {
    std::optional<decltype(work())> result;
    runLong(
        progress, [&] { result.emplace(work()); }, threads);
    return *std::move(result);
}

}  // namespace shadowcache::python
