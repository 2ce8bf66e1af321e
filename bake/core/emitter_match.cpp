#include "bake/core/emitter_match.h"

#include <fmt/core.h>

#include <algorithm>

#include "bake/core/emitter_tracer.h"
#include "common/base/error.h"
#include "common/emitters/emitter_label.h"

namespace shadowcache {

namespace {

/// "1 emitter", "2 emitters"
std::string emittersText(std::size_t count) {
    return fmt::format("{} emitter{}", count, count == 1 ? "" : "s");
}

/// Numbers of the shapes that others lack.
std::vector<std::size_t> lackedShapes(const std::vector<std::uint64_t>& shapes,
                                      const std::vector<std::uint64_t>& others) {
    std::vector<std::size_t> lacked;
    for (std::size_t e = 0; e < shapes.size(); ++e)
        if (std::ranges::find(others, shapes[e]) == others.end()) lacked.push_back(e);
    return lacked;
}

}  // namespace

std::vector<std::string> emitterLabels(const TriangleMesh& mesh, const BakeOptions& options) {
    const Emitters emitters = bakedEmitters(mesh, options);
    std::vector<std::string> labels;
    for (std::size_t e = 0; e < emitters.size(); ++e) labels.push_back(emitterLabel(emitters, e));
    return labels;
}

void requireSameEmitters(const std::filesystem::path& path, const std::vector<std::uint64_t>& found,
                         const WantedEmitters& wanted) {
    if (found == wanted.shapes) return;
    if (found.empty())
        throwFileError(path, fmt::format("counts no emitters, expected the {} of {}: it was baked "
                                         "with --no-lamps or before the set had any",
                                         wanted.shapes.size(), wanted.owner));
    if (wanted.shapes.empty())
        throwFileError(path, fmt::format("counts {}, expected none as in {}, which is of "
                                         "--no-lamps or of the set before it had any",
                                         emittersText(found.size()), wanted.owner));
    const std::vector<std::size_t> lacked = lackedShapes(wanted.shapes, found);
    if (lacked.empty())
        throwFileError(path,
                       fmt::format("counts {}, expected the {} of {}: the others were moved, "
                                   "reshaped or removed since the bake",
                                   emittersText(found.size()), wanted.shapes.size(), wanted.owner));
    const std::string first =
        wanted.labels.empty() ? "" : ", first " + wanted.labels[lacked.front()];
    throwFileError(
        path, fmt::format("does not count {} of the {} of {} where they are{}: moved, "
                          "reshaped or added since the bake",
                          lacked.size(), emittersText(wanted.shapes.size()), wanted.owner, first));
}

}  // namespace shadowcache
