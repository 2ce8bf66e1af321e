#include "render/app/resume.h"

#include <algorithm>
#include <span>

#include "common/base/content_hash.h"
#include "common/base/error.h"
#include "common/cache/checksums.h"
#include "common/image/exr.h"
#include "common/import/set_files.h"
#include "render/library/option_table.h"

namespace shadowcache {

namespace {

/// How a picture came about, beside its options.
constexpr const char* kSilent[] = {"seconds", "camera-rays-done", "processor", "groups"};

const std::string kPrefix = "shadowcache:";

/// Files are compared by their content, under whatever name (`inputs`).
///
/// @param pictures  whether PNG files are wanted, which are exposed; the EXR is not
bool matters(const std::string& name, bool pictures) {
    if (!name.starts_with(kPrefix)) return false;
    if (pictures && name == kPrefix + "exposure") return true;
    const OptionRow* row = findRow(optionTable(), name.substr(kPrefix.size()));
    return (!row || row->isCompared) &&
           std::none_of(std::begin(kSilent), std::end(kSilent),
                        [&](const char* silent) { return name == kPrefix + silent; });
}

/// A setting without the folder that a file was in.
std::string withoutFolder(const std::string& name, const std::string& value) {
    if (name != "shadowcache:camera") return value;
    return std::filesystem::path(value).filename().string();
}

std::string hashOf(const std::filesystem::path& file, References references) {
    std::error_code ignored;
    // A radiance, the name of a camera, or nothing.
    if (!std::filesystem::is_regular_file(file, ignored)) return file.string();
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
    if (file.metadata.contains(kPrefix + "incomplete")) return FrameState::broken;
    const bool pictures = std::ranges::any_of(
        metadata, [](const auto& entry) { return entry.first == kPrefix + "png"; });
    std::size_t wanted = 0;
    for (const auto& [name, value] : metadata) {
        if (!matters(name, pictures)) continue;
        ++wanted;
        const auto found = file.metadata.find(name);
        if (found == file.metadata.end() ||
            withoutFolder(name, found->second) != withoutFolder(name, value))
            return FrameState::changed;
    }
    const auto has = static_cast<std::size_t>(
        std::count_if(file.metadata.begin(), file.metadata.end(),
                      [&](const auto& entry) { return matters(entry.first, pictures); }));
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
