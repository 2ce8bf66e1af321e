#include "common/base/progress.h"

#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <utility>

#include "common/base/error.h"

namespace shadowcache {
namespace {

std::atomic<bool> interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free, "the signal handler must not lock");

extern "C" void noteInterrupt(int) {
    interrupted.store(true, std::memory_order_relaxed);
    std::signal(SIGINT, SIG_DFL);
    std::signal(SIGTERM, SIG_DFL);
}

}  // namespace

Progress::Progress(std::string label, std::uint64_t total)
    : label_(std::move(label)),
      total_(std::max<std::uint64_t>(1, total)),
      terminal_(isatty(STDERR_FILENO) != 0),
      start_(std::chrono::steady_clock::now()) {}

Progress::~Progress() {
    if (terminal_ && nextPrintMilliseconds_ > 0) std::fputs("\r\033[K", stderr);
}

void Progress::add(std::uint64_t units) {
    const std::uint64_t done = done_.fetch_add(units, std::memory_order_relaxed) + units;
    if (!terminal_) return;
    constexpr std::int64_t kIntervalMilliseconds = 100;
    const auto elapsed = std::chrono::steady_clock::now() - start_;
    const std::int64_t now = std::chrono::duration_cast<std::chrono::milliseconds>(elapsed).count();
    std::int64_t due = nextPrintMilliseconds_;
    // Whichever thread moves the time on prints; the others go back to work.
    if (now >= due &&
        nextPrintMilliseconds_.compare_exchange_strong(due, now + kIntervalMilliseconds))
        print(done, std::chrono::duration<double>(elapsed).count());
}

void Progress::print(std::uint64_t done, double seconds) {
    const double share = std::min(1.0, static_cast<double>(done) / static_cast<double>(total_));
    const double left = share > 0.0 ? seconds * (1.0 - share) / share : 0.0;
    std::fprintf(stderr, "\r%s: %.0f %%, %.0f s left\033[K", label_.c_str(), 100.0 * share, left);
}

void installInterruptHandler() {
    std::signal(SIGINT, noteInterrupt);
    std::signal(SIGTERM, noteInterrupt);
}

void throwIfInterrupted() {
    if (interrupted.load(std::memory_order_relaxed)) throw Interrupted();
}

}  // namespace shadowcache
