#include "common/import/gltf_budget.h"

#include <fmt/core.h>

#include <string>

#include "common/base/error.h"

namespace shadowcache {

namespace {

/// Elements that a file of any size may have: with all attributes some 200 MB.
constexpr std::size_t kElementsAlways = std::size_t{1} << 21;
/// Elements that a byte of the buffers may become. An element that is not shared takes a byte or
/// more; some exporters let all primitives of a mesh share one list of vertices.
constexpr std::size_t kMostElementsPerByte = 16;

}  // namespace

GltfBudget::GltfBudget(const GltfDocument& document) : document_(document), most_(kElementsAlways) {
    for (const auto& bytes : document.storage) most_ += kMostElementsPerByte * bytes.size();
}

void GltfBudget::take(std::size_t elements) {
    if (elements > most_ - taken_)
        throwFileError(
            document_.path,
            fmt::format("shares data so often that they become more than {} vertices, corners, key "
                        "numbers or texels; expected no more of buffers of this size",
                        most_));
    taken_ += elements;
}

}  // namespace shadowcache
