#include "common/cache/hit_bytes.h"

#include <set>
#include <span>
#include <vector>

#include "common/cache/cache_grids.h"
#include "common/cache/point_layout.h"

namespace shadowcache {

std::uint64_t hitBytes(const std::filesystem::path& path) {
    const CheckedFile file = openChecked(path);
    const CacheHeader header = readHeader(file);
    if (header.hits == 0) return 0;
    const std::vector<AttributeSpec> specs = itemAttributes(header);
    std::vector<FilePage> pages;
    std::set<std::uint32_t> ofHits;
    for (const LeafPlace& leaf :
         PointLayoutReader(file).read(kItemGrid, std::span(specs).subspan(kHits, 1), pages))
        ofHits.insert(leaf.arrays[0].page);
    std::uint64_t bytes = 0;
    for (const std::uint32_t page : ofHits) bytes += pages[page].stored;
    return bytes;
}

}  // namespace shadowcache
