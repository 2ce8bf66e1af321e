#pragma once

#include <chrono>

#include "render/frame/frame_request.h"

namespace shadowcache {

/// Adds the time of its life, however that ends. It only measures: time limits are kept by filmOf()
/// of render/app/run_job.cpp.
class RenderTimer {
public:
    explicit RenderTimer(RenderStats& stats) : stats_(stats) {}
    ~RenderTimer() {
        stats_.seconds +=
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    }
    RenderTimer(const RenderTimer&) = delete;
    RenderTimer& operator=(const RenderTimer&) = delete;

private:
    RenderStats& stats_;
    const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace shadowcache
