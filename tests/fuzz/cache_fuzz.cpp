// Cache files: as a whole, or in pages with lookups. The bytes are taken as they are; those of the
// corpus have sound checksums, and what is changed is refused by them.

#include <array>

#include "common/cache/cache_items.h"
#include "common/cache/shadow_cache.h"
#include "tests/fuzz/input_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    using namespace shadowcache;
    static fuzz::InputFile file("in.vdb");
    fuzz::readAs(file, {bytes, size}, [](const std::filesystem::path& path) {
#if SHADOWCACHE_FUZZ_PAGED
        const ShadowCache cache(path, 1 << 20);
        ShadowCache::Reader reader(cache);
        std::array<ItemView, ShadowCache::kMaxItems> items;
        for (int i = 0; i < 8; ++i)
            reader.lookUp(Vec3d(i & 1, i >> 1 & 1, i >> 2) * cache.header().spacing, {0, 1, 0},
                          items);
#else
        CacheHeader header;
        readCache(path, header);
#endif
    });
    return 0;
}
