#include "common/base/report_failure.h"

#include <errno.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <cstdio>
#include <new>

#include "common/base/exit_status.h"
#include "common/base/interrupt.h"

namespace shadowcache {

namespace {

/// What is said of an exception; a library's word for a lack of memory is no sentence.
const char* causeOf(const std::exception& error) noexcept {
    return dynamic_cast<const std::bad_alloc*>(&error) != nullptr ? "out of memory" : error.what();
}

/// Prints "PROGRAM: CAUSE" without an allocation, and at once: other threads may fail, too.
void sayFailure(const char* program, const char* cause) noexcept {
    char text[512];
    const int length = std::snprintf(text, sizeof text - 1, "%s: %s", program, cause);
    const auto shown = static_cast<std::size_t>(std::clamp<int>(length, 0, sizeof text - 2));
    text[shown] = '\n';
    if (write(STDERR_FILENO, text, shown + 1) < 0) return;  // nobody is left to be told
}

[[noreturn]] void endProgram() noexcept {
    // Of several threads that fail the first one is heard.
    static std::atomic_flag ending = ATOMIC_FLAG_INIT;
    while (ending.test_and_set()) pause();
    try {
        if (const auto error = std::current_exception()) std::rethrow_exception(error);
        sayFailure(program_invocation_short_name, "ended by a library, or out of memory");
    } catch (const std::exception& error) {
        sayFailure(program_invocation_short_name, causeOf(error));
    } catch (...) {
        sayFailure(program_invocation_short_name, "ended by an unknown exception");
    }
    _exit(kFailed);
}

}  // namespace

std::string oneLine(std::string text) {
    constexpr std::size_t kMost = 8192, kEnd = 512;
    if (text.size() > kMost) text.replace(kMost - kEnd, text.size() - kMost, "...");
    for (char& c : text)
        if (std::iscntrl(static_cast<unsigned char>(c))) c = '?';
    return text;
}

int reportFailure(const char* program, const std::exception& error) noexcept {
    const char* cause = causeOf(error);
    try {
        std::fprintf(stderr, "%s: %s\n", program, oneLine(cause).c_str());
    } catch (const std::bad_alloc&) {
        sayFailure(program, cause);
    }
    return dynamic_cast<const Interrupted*>(&error) != nullptr ? kTryAgain : kFailed;
}

void installFailureHandler() noexcept {
    std::set_terminate(endProgram);
    signal(SIGXFSZ, SIG_IGN);  // a write beyond ulimit -f fails then, with its cause
}

}  // namespace shadowcache
