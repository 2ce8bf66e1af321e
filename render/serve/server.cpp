#include "render/serve/server.h"

#include <errno.h>
#include <fmt/core.h>
#include <unistd.h>

#include <atomic>
#include <condition_variable>
#include <csignal>
#include <cstdio>
#include <deque>
#include <memory>
#include <mutex>
#include <new>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>
#include <utility>

#include "common/base/error.h"
#include "common/base/option_checks.h"
#include "common/base/parallel.h"
#include "common/base/report_failure.h"
#include "common/base/watch.h"
#include "render/library/option_table.h"
#include "render/serve/replies.h"
#include "render/serve/requests.h"
#include "render/serve/session.h"

namespace shadowcache {

namespace {

/// Bytes of a line; a longer one is refused, and not kept.
constexpr std::size_t kMostLine = std::size_t{1} << 20;

/// Lines of standard input.
class Lines {
public:
    /// The next line without its end; nothing at the end of the input. One that is too long is cut
    /// to kMostLine + 1 bytes.
    std::optional<std::string> next() {
        std::string line;
        for (;;) {
            for (; place_ < count_; ++place_) {
                const char c = bytes_[place_];
                if (c == '\n') {
                    ++place_;
                    return line;
                }
                if (line.size() <= kMostLine) line += c;
            }
            if (!fill()) return std::nullopt;  // a line without its end is none
        }
    }

private:
    bool fill() {
        ssize_t count = 0;
        do count = read(STDIN_FILENO, bytes_, sizeof bytes_);
        while (count < 0 && errno == EINTR);
        place_ = 0;
        count_ = count > 0 ? static_cast<std::size_t>(count) : 0;
        return count_ > 0;
    }

    char bytes_[1 << 16] = {};
    std::size_t place_ = 0, count_ = 0;
};

/// A request that waits or runs.
struct Task {
    std::uint64_t number;
    Command command;
    Watch watch;
};

/// A thread that does one request after another.
class Worker {
public:
    explicit Worker(Replies& replies)
        : replies_(replies),
          session_(
              [this](const std::string& text) {
                  replies_.log(number_, oneLine(inWordsOf(Door::serve, text)));
              },
              [this](std::uint64_t number, const Session::Reply& fields) {
                  replies_.picture(number, fields);
              }),
          thread_([this] { work(); }) {}

    void add(std::uint64_t number, Command command) {
        auto task = std::make_unique<Task>();
        task->number = number;
        task->command = std::move(command);
        task->watch.onProgress = [this, number](const std::string& name, std::uint64_t done,
                                                std::uint64_t total) {
            replies_.progress(number, name, done, total);
        };
        const std::lock_guard lock(mutex_);
        waiting_.push_back(std::move(task));
        changed_.notify_one();
    }

    /// Stops what runs and what waits.
    void stop() {
        const std::lock_guard lock(mutex_);
        if (running_) running_->watch.stop = true;
        for (const auto& task : waiting_) task->watch.stop = true;
    }

    /// Ends the thread once all is done.
    void finish() {
        {
            const std::lock_guard lock(mutex_);
            finishing_ = true;
            changed_.notify_one();
        }
        if (thread_.joinable()) thread_.join();
    }

    ~Worker() { finish(); }
    Worker(const Worker&) = delete;
    Worker& operator=(const Worker&) = delete;

    /// Once the thread has ended.
    void removePixels() noexcept { session_.removePixels(); }

private:
    void work() {
        while (Task* task = take()) {
            const WatchScope scope(&task->watch);
            answer(*task);
        }
    }

    Task* take() {
        std::unique_lock lock(mutex_);
        running_.reset();
        changed_.wait(lock, [this] { return finishing_ || !waiting_.empty(); });
        if (waiting_.empty()) return nullptr;
        running_ = std::move(waiting_.front());
        waiting_.pop_front();
        return running_.get();
    }

    void answer(const Task& task) {
        number_ = task.number;
        try {
            throwIfStopped();
            replies_.done(task.number, session_.run(task.number, task.command));
        } catch (const Interrupted&) {
            replies_.stopped(task.number);
        } catch (const std::bad_alloc&) {
            replies_.error(task.number, "out of memory");
        } catch (const std::exception& e) {
            replies_.error(task.number, oneLine(inWordsOf(Door::serve, e.what())));
        }
    }

    Replies& replies_;
    std::uint64_t number_ = 0;  ///< of the request that runs
    std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<std::unique_ptr<Task>> waiting_;
    std::unique_ptr<Task> running_;
    bool finishing_ = false;
    Session session_;
    std::jthread thread_;  // last: it uses the others
};

void writeLine(const std::string& line) {
    // Nobody may be left to read it: the input ends then, too.
    std::fputs(line.c_str(), stdout);
    std::fflush(stdout);
}

/// Reads requests to the end of the input.
///
/// @return whether they end with quit
bool readRequests(Worker& worker, Replies& replies) {
    Lines lines;
    while (const auto line = lines.next()) {
        if (line->size() > kMostLine) {
            replies.error(std::nullopt,
                          fmt::format("line longer than {} bytes, expected less", kMostLine));
            continue;
        }
        Request request = parseRequest(*line);
        if (!request.command || !request.number) {
            replies.error(request.number, oneLine(request.error));
            continue;
        }
        if (std::holds_alternative<StopRequest>(*request.command)) {
            worker.stop();
            replies.done(request.number, Replies::Json::object());
            continue;
        }
        const bool last = std::holds_alternative<QuitRequest>(*request.command);
        worker.add(*request.number, *std::move(request.command));
        if (last) return true;
    }
    return false;
}

}  // namespace

void serve(int threads) {
    requireRange("threads", threads, 0, kMaxThreads);
    setThreadCount(threads);
    std::signal(SIGPIPE, SIG_IGN);
    Replies replies(writeLine);
    Worker worker(replies);
    const bool asked = readRequests(worker, replies);
    if (!asked) worker.stop();
    worker.finish();
    if (!asked) worker.removePixels();
}

}  // namespace shadowcache
