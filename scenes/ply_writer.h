#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "common/math/vec.h"

namespace shadowcache::scenes {

/// Writes a binary PLY as its parts become known: first every vertex, then every triangle, in
/// memory that does not grow with the set.
class PlyWriter {
public:
    /// @throws Error if the file cannot be written; the later calls too
    PlyWriter(const std::filesystem::path& path, std::uint64_t vertices, std::uint64_t triangles);

    /// @param color linear albedo; stored as 8-bit sRGB
    void vertex(const Vec3f& position, const Rgb& color);
    void triangle(const Vec3i& corners);
    /// Writes what is left; the file is complete after this.
    void finish();

private:
    void put(const void* data, std::size_t size);

    std::filesystem::path path_;
    std::ofstream out_;
    std::vector<char> buffer_;
};

}  // namespace shadowcache::scenes
