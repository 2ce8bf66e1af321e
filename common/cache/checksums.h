#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <streambuf>
#include <string>
#include <vector>

#include "common/base/atomic_file.h"

namespace shadowcache {

/// Bytes of a cache file that share a checksum.
inline constexpr std::size_t kChecksumBytes = 16384;

/// Gives an OpenVDB file that is written, but not yet committed, the identifier that its content
/// has, and appends the checksums of its bytes (docs/format.md). OpenVDB does not read on behind
/// its grids.
///
/// @throws Error when it cannot be written
void sealFile(AtomicFile& file);

/// A file with checksums, open for reading: no byte is handed out that differs from its checksum.
/// Thread-safe.
class CheckedFile {
public:
    /// Opens a file and reads its checksums.
    ///
    /// @return none if it has no sound checksums: of another program, of an older format, cut short
    /// or damaged at its end
    /// @throws Error naming the file if it cannot be read
    static std::optional<CheckedFile> open(const std::filesystem::path& path);
    ~CheckedFile();
    CheckedFile(CheckedFile&& other) noexcept;
    CheckedFile& operator=(CheckedFile&&) = delete;

    const std::filesystem::path& path() const { return path_; }
    /// Bytes that have checksums: all but these themselves.
    std::uint64_t size() const { return size_; }

    /// Reads `out.size()` bytes at `offset`; of those behind the end none.
    ///
    /// @return bytes read
    /// @throws Error naming the file and the place if they differ from their checksum
    std::size_t read(std::uint64_t offset, std::span<std::byte> out) const;

    /// Begins of the pieces, of kChecksumBytes each, that differ from their checksums.
    std::vector<std::uint64_t> damaged() const;

    /// Number of checksums.
    std::size_t pieces() const { return sums_.size(); }

private:
    CheckedFile(std::filesystem::path path, int file) : path_(std::move(path)), file_(file) {}
    bool readTable(std::uint64_t fileSize);
    std::span<const std::byte> piece(std::size_t number, std::vector<std::byte>& room) const;

    std::filesystem::path path_;
    int file_;
    std::uint64_t size_ = 0;
    std::vector<std::uint64_t> sums_;
};

/// Hash of all that a file holds, as 36 characters: the identifier that sealFile() gave it.
///
/// @throws Error if the file's head is damaged
std::string contentName(const CheckedFile& file);

/// A CheckedFile for an input stream, which gives its errors through if its exceptions are on.
class CheckedBuffer final : public std::streambuf {
public:
    /// @param file  stays as long as this
    explicit CheckedBuffer(const CheckedFile& file) : file_(file), room_(kChecksumBytes) {}

protected:
    int_type underflow() override;
    pos_type seekoff(off_type offset, std::ios_base::seekdir from,
                     std::ios_base::openmode) override;
    pos_type seekpos(pos_type position, std::ios_base::openmode) override;

private:
    std::uint64_t position() const { return begin_ + static_cast<std::uint64_t>(gptr() - eback()); }

    const CheckedFile& file_;
    std::vector<char> room_;
    std::uint64_t begin_ = 0;  ///< place in the file of the byte at eback()
};

}  // namespace shadowcache
