#pragma once

#include "common/base/json_file.h"
#include "common/cache/memory_use.h"

namespace shadowcache {

/// Adds `cache.memory.*` to a render's figures, if there was a budget.
void addMemoryUse(JsonFile& out, const MemoryUse& use);

/// Prints what a budget came to, if there was one, and warns if it was not kept.
void printMemoryUse(const MemoryUse& use, std::size_t bounceBytes);

}  // namespace shadowcache
