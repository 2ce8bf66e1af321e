#include "render/python/long_call.h"

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <mutex>
#include <string>
#include <thread>

#include "common/base/call_threads.h"
#include "common/base/option_checks.h"
#include "common/base/watch.h"

namespace shadowcache::python {

namespace py = pybind11;

namespace {

/// Between two looks for signals.
constexpr std::chrono::milliseconds kPoll{50};

/// How far the work is.
struct Report {
    std::string task;
    std::uint64_t done = 0, total = 0;
};

/// Work on a thread of its own.
class Worker {
public:
    Worker(const std::function<void()>& work, int threads)
        : thread_([this, &work, threads] {
              const WatchScope scope(&watch_);
              std::exception_ptr failure;
              try {
                  withThreads(threads, work);
              } catch (...) {
                  failure = std::current_exception();
              }
              const std::lock_guard lock(mutex_);
              failure_ = failure;
              ended_ = true;
              changed_.notify_all();
          }) {}

    void stop() { watch_.stop = true; }

    /// Waits a while. Returns whether the work has ended.
    bool wait() {
        std::unique_lock lock(mutex_);
        return changed_.wait_for(lock, kPoll, [this] { return ended_; });
    }

    /// How far it is, if that is news.
    std::optional<Report> takeReport() {
        const std::lock_guard lock(mutex_);
        return std::exchange(report_, std::nullopt);
    }

    /// @throws what the work threw, once it has ended
    void rethrow() const {
        if (failure_) std::rethrow_exception(failure_);
    }

private:
    std::mutex mutex_;
    std::condition_variable changed_;
    std::optional<Report> report_;
    bool ended_ = false;
    std::exception_ptr failure_;
    Watch watch_{
        .stop = false,
        .onProgress = [this](const std::string& task, std::uint64_t done, std::uint64_t total) {
            const std::lock_guard lock(mutex_);
            // Threads may come in another order than they counted.
            if (!report_ || report_->task != task || report_->done < done)
                report_ = Report{task, done, total};
        }};
    std::jthread thread_;  // last: it uses the others
};

/// Signals are handled on Python's main thread only; elsewhere this does nothing.
void handleSignals() {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

}  // namespace

void runLong(const py::object& progress, const std::function<void()>& work, int threads) {
    requireRange("threads", threads, 0, kMaxThreads);
    std::optional<Worker> worker;
    worker.emplace(work, threads);
    std::exception_ptr raised;
    const auto waited = [&] {
        const py::gil_scoped_release release;
        return worker->wait();
    };
    while (!waited()) {
        if (raised) continue;
        try {
            handleSignals();
            if (const auto report = worker->takeReport(); report && !progress.is_none())
                progress(report->task, report->done, report->total);
        } catch (const py::error_already_set&) {
            raised = std::current_exception();
            worker->stop();
        }
    }
    if (raised) std::rethrow_exception(raised);
    worker->rethrow();
    if (const auto report = worker->takeReport(); report && !progress.is_none())
        progress(report->task, report->done, report->total);
}

}  // namespace shadowcache::python
