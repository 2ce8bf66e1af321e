#include "render/serve/pixel_file.h"

#include <errno.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstring>
#include <utility>

#include "common/base/error.h"

namespace shadowcache {

PixelFile::PixelFile(std::filesystem::path path) : path_(std::move(path)) {
    constexpr mode_t kOwner = 0600;
    // No link that another user may have put into a shared folder, and no pipe to wait at.
    file_ = open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, kOwner);
    if (file_ < 0) throwFileError(path_, std::string("cannot be written: ") + std::strerror(errno));
    struct stat state {};
    PixelHeader found;
    const PixelHeader ours;
    const bool regular = fstat(file_, &state) == 0 && S_ISREG(state.st_mode);
    const bool empty = regular && state.st_size == 0;
    const bool known = regular && pread(file_, &found, sizeof found, 0) == sizeof found &&
                       std::memcmp(found.name, ours.name, sizeof found.name) == 0;
    isNew_ = empty;
    if (empty) return;
    if (!known) {
        close(file_);
        throwFileError(path_, "is there and no file of pixels, expected a new name");
    }
    sequence_ = found.sequence + found.sequence % 2;
}

PixelFile::~PixelFile() {
    close(file_);
}

std::uint64_t PixelFile::write(PixelHeader header, std::span<const Channel> planes) {
    header.sequence = sequence_ + 1;
    header.planes = static_cast<std::uint32_t>(planes.size());
    put(&header, sizeof header, 0);
    std::size_t place = sizeof header;
    for (const Channel& plane : planes) {
        const std::size_t bytes = plane.values.size() * sizeof(float);
        put(plane.values.data(), bytes, place);
        place += bytes;
    }
    sequence_ += 2;
    put(&sequence_, sizeof sequence_, offsetof(PixelHeader, sequence));
    requireInPlace();
    return sequence_;
}

void PixelFile::requireInPlace() const {
    struct stat ours {
    }, named{};
    if (fstat(file_, &ours) != 0 || lstat(path_.c_str(), &named) != 0 ||
        ours.st_dev != named.st_dev || ours.st_ino != named.st_ino)
        throwFileError(path_, "was removed or replaced during the render");
}

void PixelFile::put(const void* bytes, std::size_t count, std::size_t place) {
    const char* from = static_cast<const char*>(bytes);
    while (count > 0) {
        const ssize_t written = pwrite(file_, from, count, static_cast<off_t>(place));
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0)
            throwFileError(path_, std::string("cannot be written: ") + std::strerror(errno));
        from += written;
        place += static_cast<std::size_t>(written);
        count -= static_cast<std::size_t>(written);
    }
}

}  // namespace shadowcache
