#include "common/base/watch.h"

namespace shadowcache {
namespace {

thread_local Watch* ofThread = nullptr;

}  // namespace

WatchScope::WatchScope(Watch* watch) noexcept : before_(ofThread) {
    ofThread = watch;
}

WatchScope::~WatchScope() {
    ofThread = before_;
}

Watch* currentWatch() noexcept {
    return ofThread;
}

void throwIfStopped() {
    if (ofThread && ofThread->stop.load(std::memory_order_relaxed)) throw Interrupted();
}

}  // namespace shadowcache
