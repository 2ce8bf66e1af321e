#pragma once

#include <string>

#include "bake/inspect/info_text.h"

namespace shadowcache {

/// An HTML page about a cache that needs no other file: settings, slices, histograms.
///
/// @param name  of the cache, for the title
std::string reportPage(const std::string& name, const CacheFacts& facts);

}  // namespace shadowcache
