#include "common/base/progress.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <utility>

namespace shadowcache {
namespace {

ProgressStyle chosenStyle = ProgressStyle::none;
std::optional<std::int64_t> chosenInterval;

std::int64_t intervalOf(ProgressStyle style, const Watch* watch) {
    if (watch) return 100;
    if (chosenInterval) return *chosenInterval;
    switch (style) {
        case ProgressStyle::bar:
            return 100;
        case ProgressStyle::json:
            return 1000;
        default:
            return 10000;
    }
}

}  // namespace

ProgressStyle standardProgressStyle() {
    return isatty(STDERR_FILENO) != 0 ? ProgressStyle::bar : ProgressStyle::lines;
}

void setProgressStyle(ProgressStyle style, std::optional<std::int64_t> milliseconds) {
    chosenStyle = style;
    chosenInterval = milliseconds;
}

Progress::Progress(std::string label, std::uint64_t total)
    : label_(std::move(label)),
      total_(std::max<std::uint64_t>(1, total)),
      watch_(currentWatch()),
      style_(watch_ ? ProgressStyle::json : chosenStyle),
      intervalMilliseconds_(intervalOf(style_, watch_)),
      start_(std::chrono::steady_clock::now()),
      nextPrintMilliseconds_(style_ == ProgressStyle::bar ? 0 : intervalMilliseconds_) {}

Progress::~Progress() {
    if (style_ == ProgressStyle::bar && printed_) std::fputs("\r\033[K", stderr);
}

void Progress::add(std::uint64_t units) {
    const std::uint64_t done = done_.fetch_add(units, std::memory_order_relaxed) + units;
    if (style_ == ProgressStyle::none) return;
    const auto elapsed = std::chrono::steady_clock::now() - start_;
    const std::int64_t now = std::chrono::duration_cast<std::chrono::milliseconds>(elapsed).count();
    std::int64_t due = nextPrintMilliseconds_;
    // Whichever thread moves the time on prints; the others go back to work.
    const bool itIsTime = now >= due && nextPrintMilliseconds_.compare_exchange_strong(
                                            due, now + intervalMilliseconds_);
    const bool atTheEnd = done == total_ && (style_ == ProgressStyle::json || printed_);
    if (itIsTime || atTheEnd) {
        printed_ = true;
        show(done, std::chrono::duration<double>(elapsed).count());
    }
}

void Progress::show(std::uint64_t done, double seconds) const {
    if (watch_) return watch_->onProgress(label_, done, total_);
    const double share = std::min(1.0, static_cast<double>(done) / static_cast<double>(total_));
    const double left = share > 0.0 ? seconds * (1.0 - share) / share : 0.0;
    if (style_ == ProgressStyle::json)
        std::fprintf(
            stderr,
            "{\"task\":\"%s\",\"done\":%llu,\"total\":%llu,\"seconds\":%.1f,\"left\":%.1f}\n",
            label_.c_str(), static_cast<unsigned long long>(done),
            static_cast<unsigned long long>(total_), seconds, left);
    else
        std::fprintf(stderr, "%s%s: %.0f %%, %.0f s left%s",
                     style_ == ProgressStyle::bar ? "\r" : "", label_.c_str(), 100.0 * share, left,
                     style_ == ProgressStyle::bar ? "\033[K" : "\n");
}

}  // namespace shadowcache
