#include "common/base/interrupt.h"

#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>

#include "common/base/exit_status.h"

namespace shadowcache {
namespace {

/// Seconds from the signal to the end of a process that is not in a loop of ours: reading a set and
/// building its acceleration structure take longer and cannot be left. Schedulers grant five or
/// more before they kill.
constexpr unsigned kGraceSeconds = 4;

std::atomic<bool> interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free, "the signal handler must not lock");

void say(const char* text) {
    if (write(STDERR_FILENO, text, std::strlen(text)) < 0) return;  // nobody is left to be told
}

extern "C" void endAtOnce(int) {
    say(program_invocation_short_name);
    say(": interrupted\n");
    _exit(kTryAgain);
}

extern "C" void noteInterrupt(int) {
    interrupted.store(true, std::memory_order_relaxed);
    std::signal(SIGINT, SIG_DFL);
    std::signal(SIGTERM, SIG_DFL);
    alarm(kGraceSeconds);
}

}  // namespace

void installInterruptHandler() {
    std::signal(SIGALRM, endAtOnce);
    std::signal(SIGINT, noteInterrupt);
    std::signal(SIGTERM, noteInterrupt);
}

bool mustEnd(const Watch* watch) noexcept {
    return interrupted.load(std::memory_order_relaxed) ||
           (watch && watch->stop.load(std::memory_order_relaxed));
}

void throwIfInterrupted() {
    if (mustEnd(currentWatch())) throw Interrupted();
}

}  // namespace shadowcache
