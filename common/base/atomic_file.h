#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string_view>

namespace shadowcache {

/// Refuses a place that no file can be written to, before long work and not after it. What stands
/// there may be replaced if it is a regular file, but no device or pipe.
///
/// @throws Error naming the file and the cause
void requireWritable(const std::filesystem::path& path);

/// Makes a rename or a new file in a folder outlast a power cut, where the disk can.
void syncFolder(const std::filesystem::path& folder);

/// File that appears under its name only when complete: written beside under temporaryPath(),
/// locked against removeLeftovers(), renamed by commit(), removed if commit() is not reached.
class AtomicFile {
public:
    /// @throws Error if the file cannot be created there
    explicit AtomicFile(const std::filesystem::path& path);
    ~AtomicFile();
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;

    /// Each throws Error when the disk refuses (full, broken).
    void write(const void* bytes, std::size_t count);
    /// Bytes written before; seek() comes before it, and before the next write.
    void read(void* bytes, std::size_t count);
    void seek(std::uint64_t position);
    std::uint64_t position() const;
    void commit();

private:
    [[noreturn]] void fail(const char* action);

    std::filesystem::path path_;
    std::filesystem::path partPath_;
    std::FILE* file_ = nullptr;
    bool failed_ = false;  ///< a library may have swallowed the exception
};

/// Writes a file that appears when it is complete, and removes what dead runs left of it.
///
/// @throws Error if the disk refuses
void writeWhole(const std::filesystem::path& path, std::string_view bytes);

}  // namespace shadowcache
