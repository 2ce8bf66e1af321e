#pragma once

#include <filesystem>
#include <string>

namespace shadowcache {

/// Writes a seed; its folder is the fuzzer's name.
void writeSeed(const std::filesystem::path& path, const std::string& bytes);

/// Seeds of the readers of sets.
void writeImportSeeds(const std::filesystem::path& folder);

}  // namespace shadowcache
