#include "common/base/atomic_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "common/base/error.h"
#include "common/base/leftovers.h"

namespace shadowcache {

namespace {

std::filesystem::path folderOf(const std::filesystem::path& path) {
    return path.has_parent_path() ? path.parent_path() : ".";
}

}  // namespace

void syncFolder(const std::filesystem::path& folder) {
    // Some network disks refuse it; the file itself is on the disk by then.
    const int descriptor = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor < 0) return;
    fsync(descriptor);
    close(descriptor);
}

void requireWritable(const std::filesystem::path& path) {
    std::error_code failure;
    const auto status = std::filesystem::status(path, failure);
    if (failure == std::errc::filename_too_long)
        throwFileError(path, "cannot be created: " + failure.message());
    if (std::filesystem::is_directory(status))
        throwFileError(path, "is a directory, expected a file to write");
    if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
        throwFileError(path, "is a device or pipe, expected a file to write");
    if (access(folderOf(path).c_str(), W_OK | X_OK) != 0)
        throwFileError(path, std::string("cannot be created: ") + std::strerror(errno));
}

AtomicFile::AtomicFile(const std::filesystem::path& path) : path_(path) {
    requireWritable(path_);
    int file = -1;
    for (bool own = false; !own;) {
        partPath_ = temporaryPath(path);
        file = open(partPath_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (file < 0 && errno == EEXIST) continue;
        if (file < 0) fail("created");
        // Another run may take it for a leftover until it is locked.
        struct stat status = {};
        own = !(flock(file, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) &&
              fstat(file, &status) == 0 && status.st_nlink > 0;
        if (!own) close(file);
    }
    file_ = fdopen(file, "w+b");
    if (file_) return;
    close(file);
    fail("created");
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

void AtomicFile::read(void* bytes, std::size_t count) {
    if (std::fread(bytes, 1, count, file_) != count) fail("read back");
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
    const int lock = fcntl(fileno(file_), F_DUPFD_CLOEXEC, 0);  // until it has its name
    const bool done = std::fclose(std::exchange(file_, nullptr)) == 0 &&
                      std::rename(partPath_.c_str(), path_.c_str()) == 0;
    const int error = errno;
    if (lock >= 0) close(lock);
    if (!done) {
        std::error_code ignored;
        std::filesystem::remove(partPath_, ignored);
        errno = error;
        fail("written");
    }
    syncFolder(folderOf(path_));
}

void AtomicFile::fail(const char* action) {
    failed_ = true;
    throwFileError(path_, std::string("cannot be ") + action + ": " + std::strerror(errno));
}

void writeWhole(const std::filesystem::path& path, std::string_view bytes) {
    std::vector<Leftover> kept;
    removeLeftovers(path, kept);
    AtomicFile file(path);
    file.write(bytes.data(), bytes.size());
    file.commit();
}

}  // namespace shadowcache
