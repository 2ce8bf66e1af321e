#pragma once

#include <chrono>

#include "render/frame/frame_request.h"

namespace shadowcache {

/// Adds the time of its life, however that ends.
class TimeKeeper {
public:
    explicit TimeKeeper(RenderStats& stats) : stats_(stats) {}
    ~TimeKeeper() {
        stats_.seconds +=
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    }
    TimeKeeper(const TimeKeeper&) = delete;
    TimeKeeper& operator=(const TimeKeeper&) = delete;

private:
    RenderStats& stats_;
    const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace shadowcache
