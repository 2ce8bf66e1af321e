#include "common/base/atomic_file.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

#include "common/base/error.h"

namespace shadowcache {

void requireWritable(const std::filesystem::path& path) {
    std::error_code ignored;
    const auto status = std::filesystem::status(path, ignored);
    if (std::filesystem::is_directory(status))
        throwFileError(path, "is a directory, expected a file to write");
    if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
        throwFileError(path, "is a device or pipe, expected a file to write");
    const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
    if (access(folder.c_str(), W_OK | X_OK) != 0)
        throwFileError(path, std::string("cannot be created: ") + std::strerror(errno));
}

AtomicFile::AtomicFile(const std::filesystem::path& path)
    : path_(path), partPath_(path.string() + ".part-" + std::to_string(getpid())) {
    requireWritable(path_);
    file_ = std::fopen(partPath_.c_str(), "wb");
    if (!file_) fail("created");
}

AtomicFile::~AtomicFile() {
    if (!file_) return;
    std::fclose(file_);
    std::error_code ignored;
    std::filesystem::remove(partPath_, ignored);
}

void AtomicFile::write(const void* bytes, std::size_t count) {
    if (std::fwrite(bytes, 1, count, file_) != count) fail("written");
}

void AtomicFile::seek(std::uint64_t position) {
    if (fseeko(file_, static_cast<off_t>(position), SEEK_SET) != 0) fail("written");
}

std::uint64_t AtomicFile::position() const {
    return static_cast<std::uint64_t>(ftello(file_));
}

void AtomicFile::commit() {
    if (failed_) throwFileError(path_, "cannot be written: an earlier write failed");
    // Some file systems report a full disk only now.
    if (std::fflush(file_) != 0 || fsync(fileno(file_)) != 0) fail("written");
    const bool closed = std::fclose(std::exchange(file_, nullptr)) == 0;
    if (!closed || std::rename(partPath_.c_str(), path_.c_str()) != 0) {
        const int error = errno;
        std::error_code ignored;
        std::filesystem::remove(partPath_, ignored);
        errno = error;
        fail("written");
    }
}

void AtomicFile::fail(const char* action) {
    failed_ = true;
    throwFileError(path_, std::string("cannot be ") + action + ": " + std::strerror(errno));
}

}  // namespace shadowcache
