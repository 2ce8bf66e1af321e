#include "common/base/memory_limit.h"

#include <fmt/core.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <system_error>

#include "common/base/error.h"

namespace shadowcache {

namespace {

/// Of the machine, or what `ulimit -v` leaves of it.
std::uint64_t mostMemory() {
    const auto machine = static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) *
                         static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
    rlimit limit{};
    if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return machine;
    return std::min<std::uint64_t>(machine, limit.rlim_cur);
}

}  // namespace

void requireFitsMemory(const std::filesystem::path& path) {
    std::error_code error;
    const std::uint64_t size = std::filesystem::file_size(path, error), most = mostMemory();
    if (error || size < most) return;
    constexpr double kGigabyte = 1e9;
    throwFileError(path, fmt::format("has {:.1f} GB, expected less than the {:.1f} GB of memory",
                                     static_cast<double>(size) / kGigabyte,
                                     static_cast<double>(most) / kGigabyte));
}

}  // namespace shadowcache
