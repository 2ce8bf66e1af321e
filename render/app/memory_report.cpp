#include "render/app/memory_report.h"

#include <cinttypes>
#include <cstdio>

namespace shadowcache {

void addMemoryUse(JsonFile& out, const MemoryUse& use) {
    if (use.budget == 0) return;
    out.set("cache.memory.budget", use.budget);
    out.set("cache.memory.peak", use.peak);
    out.set("cache.memory.loads", use.loads);
    out.set("cache.memory.drops", use.drops);
    out.set("cache.memory.bytes_read", use.bytesRead);
}

void printMemoryUse(const MemoryUse& use, std::size_t bounceBytes) {
    if (use.budget == 0) return;
    constexpr double kMega = 1024.0 * 1024.0;
    std::printf("cache in %.1f MB at most: %.1f MB read in %" PRIu64 " parts, %" PRIu64
                " dropped again",
                static_cast<double>(use.peak) / kMega, static_cast<double>(use.bytesRead) / kMega,
                use.loads, use.drops);
    if (bounceBytes > 0)
        std::printf("; what it knows of bounces in %.1f MB more",
                    static_cast<double>(bounceBytes) / kMega);
    std::printf("\n");
    if (use.peak <= use.budget) return;
    std::fprintf(stderr,
                 "shadowcache-render: warning: --memory %" PRIu64
                 ": what was looked at at one time "
                 "took %" PRIu64 " bytes of the cache\n",
                 use.budget, use.peak);
}

}  // namespace shadowcache
