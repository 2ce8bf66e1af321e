#include "common/cache/stored_bytes.h"

#include <set>
#include <span>
#include <vector>

#include "common/cache/cache_grids.h"
#include "common/cache/point_layout.h"

namespace shadowcache {

namespace {

/// Of an attribute of the items.
std::uint64_t bytesOfAttribute(const CheckedFile& file, const AttributeSpec& attribute) {
    std::vector<FilePage> pages;
    std::set<std::uint32_t> used;
    for (const LeafPlace& leaf :
         PointLayoutReader(file).read(kItemGrid, std::span(&attribute, 1), pages))
        used.insert(leaf.arrays[0].page);
    std::uint64_t bytes = 0;
    for (const std::uint32_t page : used) bytes += pages[page].stored;
    return bytes;
}

}  // namespace

StoredBytes storedBytes(const std::filesystem::path& path) {
    const CheckedFile file = openChecked(path);
    const CacheHeader header = readHeader(file);
    const std::vector<AttributeSpec> specs = itemAttributes(header);
    StoredBytes bytes;
    if (header.hits > 0) bytes.hits = bytesOfAttribute(file, specs[kHits]);
    if (!header.emitters.empty())
        bytes.emitters = bytesOfAttribute(file, specs[emitterPlace(header)]);
    return bytes;
}

}  // namespace shadowcache
