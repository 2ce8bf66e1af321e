#include "render/app/bake_of_shot.h"

#include <fmt/core.h>

#include <algorithm>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "bake/app/command_line.h"
#include "common/base/error.h"
#include "common/base/number_text.h"
#include "common/cache/cache_items.h"

namespace shadowcache {

namespace {

/// Options of both programs that a bake depends on, or that are of how it runs.
constexpr std::string_view kShared[] = {"up",      "scale",   "set-frame", "allow-external",
                                        "frames",  "size",    "shutter",   "fps",
                                        "threads", "progress"};

std::string textOf(const DynamicFile& file) {
    return file.track.empty() ? file.mesh.string() : file.mesh.string() + "@" + file.track.string();
}

/// The command line of shadowcache-bake.
std::vector<std::string> wordsOf(const RenderJob& job) {
    const StageOptions& stage = job.stage;
    std::vector<std::string> words{"shadowcache-bake", "--output=" + stage.cache.string(),
                                   "--camera=" + job.camera.name};
    for (const auto& [name, value] : job.run.settings)
        if (std::ranges::find(kShared, name) != std::end(kShared))
            words.push_back("--" + name + "=" + value);
    for (const DynamicFile& file : stage.set.dynamic) words.push_back("--dynamic=" + textOf(file));
    if (!job.run.bakeQuality.empty()) words.push_back("--quality=" + job.run.bakeQuality);
    if (job.run.bakeSpacing > 0) words.push_back("--spacing=" + numberText(job.run.bakeSpacing));
    if (job.run.resume) words.emplace_back("--resume");
    words.emplace_back("--");
    for (const auto& file : stage.set.files) words.push_back(file.string());
    return words;
}

}  // namespace

BakeJob bakeOfShot(const RenderJob& job) {
    std::vector<std::string> words = wordsOf(job);
    std::vector<char*> argv;
    argv.reserve(words.size() + 1);
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    BakeJob bake;
    if (parseArguments(static_cast<int>(words.size()), argv.data(), bake))
        throw Error("--bake: shadowcache-bake refuses its options");
    return bake;
}

void requireOfShot(const BakeJob& bake) {
    const CacheHeader header = readHeader(bake.output);
    if (!header.part) return;  // all of the set
    const std::string wanted = ShotSource(bake.shot, bake.files, bake.mesh).text();
    const std::string between = "; ";
    if ((between + header.part->shots + between).find(between + wanted + between) ==
        std::string::npos)
        throwFileError(bake.output,
                       fmt::format("baked for {}, expected {}: remove it, name another file, or "
                                   "render with it by --cache",
                                   header.part->shots, wanted));
}

const TriangleMesh* meshForBake(const RenderJob& job, const TriangleMesh& mesh) {
    // Shading normals are more than a bake reads; surfaces without their light are less.
    const MeshOptions& options = job.stage.set.mesh;
    return options.gloss && options.lamps && options.gains.empty() ? &mesh : nullptr;
}

void bakeShot(const RenderJob& job, const BakeJob& bake, const TriangleMesh& mesh,
              PartialCache* partial) {
    run(bake, {meshForBake(job, mesh), partial});
}

}  // namespace shadowcache
