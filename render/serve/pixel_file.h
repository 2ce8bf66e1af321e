#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

#include "common/image/exr.h"

namespace shadowcache {

/// The first bytes of a file of pixels; numbers are little-endian. Behind it stand the planes, each
/// of width x height floats, row by row from the top.
struct PixelHeader {
    char name[8] = {'S', 'H', 'C', 'P', 'I', 'X', 'E', 'L'};
    std::uint64_t sequence = 0;  ///< odd while the rest is written; each picture adds 2
    std::uint32_t version = 1;
    std::uint32_t headerBytes = 64;  ///< where the first plane begins
    std::uint32_t planes = 0;
    std::uint32_t width = 0, height = 0;
    std::uint32_t x = 0, y = 0;  ///< of the first pixel in the frame
    std::uint32_t frameWidth = 0, frameHeight = 0;
    std::uint32_t unused = 0;
    std::uint64_t request = 0;  ///< number of the request that rendered it
};
static_assert(sizeof(PixelHeader) == 64);

/// A file of pixels, which other processes map. Written in place under a sequence number
/// (a seqlock); it never becomes shorter, so that what others have mapped stays.
class PixelFile {
public:
    /// Opens the file, or makes it, readable by its owner alone.
    ///
    /// @throws Error if it cannot be written, or is there and no file of pixels
    explicit PixelFile(std::filesystem::path path);
    ~PixelFile();
    PixelFile(const PixelFile&) = delete;
    PixelFile& operator=(const PixelFile&) = delete;

    const std::filesystem::path& path() const { return path_; }
    /// Whether it was made now, or was empty: nobody else's.
    bool isNew() const { return isNew_; }

    /// Writes a picture.
    ///
    /// @param header  all but sequence and planes
    /// @param planes  each of width x height values
    /// @return its sequence number
    /// @throws Error if the disk refuses; the sequence number then stays odd. If the file is no
    /// longer what stands under its name, where nobody would find the picture
    std::uint64_t write(PixelHeader header, std::span<const Channel> planes);

private:
    void requireInPlace() const;
    void put(const void* bytes, std::size_t count, std::size_t place);

    std::filesystem::path path_;
    int file_ = -1;
    bool isNew_ = false;
    std::uint64_t sequence_ = 0;
};

}  // namespace shadowcache
