#include "bake/core/cache_part.h"

#include <algorithm>

namespace shadowcache {

namespace {

/// The texts of both lists, each once.
std::string joinTexts(const std::string& a, const std::string& b) {
    const std::string between = "; ";
    std::string joined = a;
    for (std::size_t begin = 0; begin < b.size();) {
        const std::size_t end = std::min(b.find(between, begin), b.size());
        const std::string text = b.substr(begin, end - begin);
        if ((between + joined + between).find(between + text + between) == std::string::npos)
            joined += (joined.empty() ? "" : between) + text;
        begin = end + between.size();
    }
    return joined;
}

}  // namespace

std::uint64_t countSides(const CacheItems& items) {
    std::uint64_t count = 0;
    const auto side = [&](std::size_t i) { return PatchCode::of(items.patch[i]).side; };
    for (std::size_t i = 0; i < items.size(); ++i)
        count += i == 0 || items.voxel[i] != items.voxel[i - 1] || side(i) != side(i - 1) ? 1 : 0;
    return count;
}

CachePart joinParts(const CachePart& a, const CachePart& b) {
    return {0, a.sidesOfSet, joinTexts(a.shots, b.shots)};
}

std::optional<CachePart> countPart(CachePart part, const CacheItems& items) {
    part.sides = countSides(items);
    if (part.sides == part.sidesOfSet) return std::nullopt;
    return part;
}

}  // namespace shadowcache
