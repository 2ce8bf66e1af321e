#pragma once

#include <filesystem>

namespace shadowcache {

/// Refuses an OpenEXR file whose header asks for more than the file can hold: attributes longer
/// than the file, or a data window with more rows of chunks, tiles or texels than its bytes allow.
/// OpenEXR allocates what a header states before it reads.
///
/// @throws Error naming the file and what is found
void requireSoundExrHeader(const std::filesystem::path& path);

}  // namespace shadowcache
