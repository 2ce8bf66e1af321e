#include "render/app/resume.h"

#include <algorithm>
#include <sstream>

#include "common/base/error.h"
#include "common/base/hash.h"
#include "common/image/exr.h"

namespace shadowcache {

namespace {

constexpr const char* kSilent[] = {"seconds",   "threads", "output",      "frames",
                                   "stats",     "resume",  "png",         "exposure",
                                   "reference", "memory",  "progressive", "camera-rays-done",
                                   "progress"};

bool matters(const std::string& name) {
    const std::string prefix = "shadowcache:";
    if (!name.starts_with(prefix)) return false;
    return std::none_of(std::begin(kSilent), std::end(kSilent),
                        [&](const char* silent) { return name == prefix + silent; });
}

}  // namespace

FrameState frameState(const std::filesystem::path& path, const Metadata& metadata, int width,
                      int height) {
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) return FrameState::missing;
    ExrFile file;
    try {
        file = readExr(path);
    } catch (const Error&) {
        return FrameState::broken;
    }
    if (file.width != width || file.height != height) return FrameState::changed;
    std::size_t wanted = 0;
    for (const auto& [name, value] : metadata) {
        if (!matters(name)) continue;
        ++wanted;
        const auto found = file.metadata.find(name);
        if (found == file.metadata.end() || found->second != value) return FrameState::changed;
    }
    const auto has = static_cast<std::size_t>(
        std::count_if(file.metadata.begin(), file.metadata.end(),
                      [](const auto& entry) { return matters(entry.first); }));
    return has == wanted ? FrameState::done : FrameState::changed;
}

std::string inputsMark(std::span<const std::filesystem::path> files) {
    std::uint64_t mark = 0;
    for (const auto& path : files) {
        std::error_code error;
        const auto size = std::filesystem::file_size(path, error);
        const auto time = std::filesystem::last_write_time(path, error).time_since_epoch().count();
        mark = hashWords(mark, size, static_cast<std::uint64_t>(time));
    }
    std::ostringstream text;
    text << std::hex << mark;
    return text.str();
}

}  // namespace shadowcache
