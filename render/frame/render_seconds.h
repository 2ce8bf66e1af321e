#pragma once

#include <chrono>

#include "render/frame/frame_request.h"

namespace shadowcache {

/// Adds the time of its life, however that ends.
class RenderSeconds {
public:
    explicit RenderSeconds(RenderStats& stats) : stats_(stats) {}
    ~RenderSeconds() {
        stats_.seconds +=
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    }
    RenderSeconds(const RenderSeconds&) = delete;
    RenderSeconds& operator=(const RenderSeconds&) = delete;

private:
    RenderStats& stats_;
    const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace shadowcache
