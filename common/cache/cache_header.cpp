#include "common/cache/cache_header.h"

#include <cstdio>

namespace shadowcache {

std::string fingerprintText(std::uint64_t fingerprint) {
    char text[17];
    std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(fingerprint));
    return text;
}

}  // namespace shadowcache
