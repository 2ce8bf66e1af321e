#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>

namespace shadowcache {

struct OmCounts {
    std::uint32_t vertices = 0;
    std::uint32_t faces = 0;
    bool hasTexcoords = false, hasFaceColors = false;  ///< which are not read
};

/// Walks through all chunks of a file of OpenMesh's own format and refuses whatever its reader
/// would trust blindly (it makes up what is missing and aborts the process on odd chunks).
///
/// @param newestVersion  of the reader, major and minor as in the file's fourth byte
/// @throws Error naming the file and what is wrong
OmCounts checkOm(const std::filesystem::path& path, std::string_view bytes,
                 std::uint8_t newestVersion);

}  // namespace shadowcache
