#pragma once

#include <chrono>

#include "render/frame/frame_request.h"

namespace shadowcache {

/// Adds the time of its life, however that ends.
class RenderClock {
public:
    explicit RenderClock(RenderStats& stats) : stats_(stats) {}
    ~RenderClock() {
        stats_.seconds +=
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    }
    RenderClock(const RenderClock&) = delete;
    RenderClock& operator=(const RenderClock&) = delete;

private:
    RenderStats& stats_;
    const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace shadowcache
