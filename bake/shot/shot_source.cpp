#include "bake/shot/shot_source.h"

#include <fmt/core.h>

#include "bake/shot/shot_lookups.h"
#include "common/base/content_hash.h"
#include "common/base/number_text.h"
#include "common/base/option_checks.h"
#include "common/import/set_files.h"
#include "common/shot/frames.h"

namespace shadowcache {

void validate(const ShotOptions& options) {
    requireRange("size (width)", options.size[0], 1, 65536);
    requireRange("size (height)", options.size[1], 1, 65536);
    requireRange("margin", options.margin, 0, 64);
    requireRange("fps", options.fps, 1e-3, 1e6);
}

std::vector<std::filesystem::path> filesOf(const ShotOptions& options) {
    std::vector<std::filesystem::path> files{options.camera.name};
    for (const DynamicFile& file : options.dynamic) {
        files.push_back(file.mesh);
        files.push_back(file.track);
    }
    return files;
}

ShotSource::ShotSource(const ShotOptions& options, std::span<const std::filesystem::path> files,
                       const MeshOptions& mesh)
    : options_(options),
      mesh_(mesh),
      contents_(contentHashOf(files, mesh.references) +
                contentHashOf(filesOf(options), mesh.references)),
      frames_(parseFrames(options.frames)),
      shots_(openShots(files, mesh, options.fps)),
      camera_(options.camera, shots_) {
    for (const int frame : frames_) camera_.moveAt(frame);
}

LookupPlaces ShotSource::lookups(Scene& scene, const VoxelFrame& frame) const {
    const std::vector<DynamicObject> objects = openDynamic(options_.dynamic, mesh_, options_.fps);
    MovingSet moving(shots_, objects, mesh_, scene.mesh().origin);
    for (const int number : frames_) moving.requireFrame(number);
    return lookupsOf({camera_, moving, frames_, options_.size}, scene, frame);
}

std::uint64_t ShotSource::pixels() const {
    return std::uint64_t{frames_.size()} * static_cast<std::uint64_t>(options_.size[0]) *
           static_cast<std::uint64_t>(options_.size[1]);
}

std::string ShotSource::text() const {
    const std::string& camera = options_.camera.name;
    std::string text = fmt::format(
        "{}, frames {}, {}x{}",
        options_.camera.isFile() ? std::filesystem::path(camera).filename().string() : camera,
        options_.frames, options_.size[0], options_.size[1]);
    if (options_.camera.shutter > 0) text += fmt::format(", shutter {:g}", options_.camera.shutter);
    if (options_.margin > 0) text += fmt::format(", margin {}", options_.margin);
    ContentHash shot;
    shot.addText(contents_);
    shot.addText(numberText(options_.fps));
    constexpr int kDigits = 8;
    return text + ", #" + shot.text().substr(0, kDigits);
}

}  // namespace shadowcache
