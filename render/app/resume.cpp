#include "render/app/resume.h"

#include <algorithm>
#include <span>

#include "common/base/content_hash.h"
#include "common/base/error.h"
#include "common/cache/checksums.h"
#include "common/image/exr.h"
#include "common/import/set_files.h"

namespace shadowcache {

namespace {

/// The files among them are compared by their content, under whatever name (`inputs`).
constexpr const char* kSilent[] = {
    "SET",       "cache",  "env",         "dynamic",          "seconds",  "threads",
    "output",    "frames", "stats",       "resume",           "png",      "exposure",
    "reference", "memory", "progressive", "camera-rays-done", "progress", "processor"};

bool matters(const std::string& name) {
    const std::string prefix = "shadowcache:";
    if (!name.starts_with(prefix)) return false;
    return std::none_of(std::begin(kSilent), std::end(kSilent),
                        [&](const char* silent) { return name == prefix + silent; });
}

/// A setting without the folder that a file was in.
std::string withoutFolder(const std::string& name, const std::string& value) {
    if (name != "shadowcache:camera") return value;
    return std::filesystem::path(value).filename().string();
}

std::string hashOf(const std::filesystem::path& file, References references) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(file, ignored)) return "none";
    // A cache states its content, which may be more than there is time to read.
    if (const auto cache = CheckedFile::open(file)) return contentName(*cache);
    return contentHashOf(std::span(&file, 1), references);
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
        if (found == file.metadata.end() ||
            withoutFolder(name, found->second) != withoutFolder(name, value))
            return FrameState::changed;
    }
    const auto has = static_cast<std::size_t>(
        std::count_if(file.metadata.begin(), file.metadata.end(),
                      [](const auto& entry) { return matters(entry.first); }));
    return has == wanted ? FrameState::done : FrameState::changed;
}

std::string InputHashes::of(std::span<const std::filesystem::path> files) {
    ContentHash hash;
    for (const auto& file : files) {
        auto& known = known_[file];
        if (known.empty()) known = hashOf(file, references_);
        hash.addText(known);
    }
    return hash.text();
}

}  // namespace shadowcache
