#include "render/app/frame_check.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstdio>

#include "common/base/error.h"
#include "common/cache/cache_items.h"
#include "render/app/frame_metadata.h"

namespace shadowcache {

namespace {

/// Frames that are named at most; a job of which nothing is there does not fill the screen.
constexpr std::size_t kMostNamed = 20;

const char* textOf(FrameState state) {
    switch (state) {
        case FrameState::missing:
            return "missing";
        case FrameState::broken:
            return "incomplete";
        case FrameState::changed:
            return "from other settings or files";
        case FrameState::done:
            break;
    }
    return "done";
}

/// The fingerprint of a cache, read from its header; none without one. @throws Error
std::optional<std::uint64_t> fingerprintOf(const std::filesystem::path& cache) {
    if (cache.empty()) return std::nullopt;
    return readHeader(cache).fingerprint;
}

/// The state of the job's frames, by their place in the job.
class FrameStates {
public:
    FrameStates(const RenderJob& job, const PictureSettings& settings, const LightPlan& plan,
                InputHashes& inputs)
        : job_(job),
          settings_(settings),
          plan_(plan),
          inputs_(inputs),
          fingerprint_(fingerprintOf(job.stage.cache)) {}

    FrameState operator[](std::size_t i) const {
        const int frame = job_.run.frames[i];
        return stateOfFrame(
            job_, settings_,
            frameMetadata(job_, settings_, fingerprint_, plan_.at(i), frame, inputs_), frame);
    }

private:
    const RenderJob& job_;
    const PictureSettings& settings_;
    const LightPlan& plan_;
    InputHashes& inputs_;
    const std::optional<std::uint64_t> fingerprint_;
};

}  // namespace

FrameState stateOfFrame(const RenderJob& job, const PictureSettings& settings,
                        const Metadata& metadata, int frame) {
    const auto files = frameFiles(job, frame);
    const FilmRectangle region = settings.options.region();
    const FrameState state = frameState(files.front(), metadata, region.width, region.height);
    // The others are written after the EXR: where they are older they are of an earlier one.
    const bool all = std::ranges::all_of(files, [&](const auto& file) {
        std::error_code missing, ignored;
        const auto written = std::filesystem::last_write_time(file, missing);
        return !missing && written >= std::filesystem::last_write_time(files.front(), ignored);
    });
    return state == FrameState::done && !all ? FrameState::missing : state;
}

bool allFramesDone(const RenderJob& job, const PictureSettings& settings, const LightPlan& plan,
                   InputHashes& inputs) {
    const FrameStates states(job, settings, plan, inputs);
    for (std::size_t i = 0; i < job.run.frames.size(); ++i)
        if (states[i] != FrameState::done) return false;
    return true;
}

void checkFrames(const RenderJob& job, const PictureSettings& settings, const LightPlan& plan,
                 InputHashes& inputs) {
    const FrameStates states(job, settings, plan, inputs);
    const std::size_t count = job.run.frames.size();
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const FrameState state = states[i];
        if (state == FrameState::done) continue;
        if (++wrong <= kMostNamed)
            std::fprintf(stderr, "%s: %s\n", frameFile(job, job.run.frames[i]).c_str(),
                         textOf(state));
    }
    if (wrong > 0)
        throw Error(
            fmt::format("--check: {} of {} frames are done, expected all", count - wrong, count));
    std::printf("%zu frame%s, all done -> %s\n", count, count == 1 ? "" : "s",
                outputName(job).c_str());
}

}  // namespace shadowcache
