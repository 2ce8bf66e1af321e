#include "common/cache/checksums.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <string_view>
#include <utility>

#include "common/base/content_hash.h"
#include "common/base/error.h"
#include "common/base/parallel.h"

namespace shadowcache {

namespace {

/// The file's last bytes; before them is the table of checksums.
struct Footer {
    std::uint64_t size;        ///< bytes before the table
    std::uint64_t pieceBytes;  ///< kChecksumBytes
    std::uint64_t tableSum;    ///< checksum of the table and of the two numbers above
    std::array<char, 8> magic;
};
static_assert(sizeof(Footer) == 32);

constexpr std::string_view kMagic = "ShcSums1";

/// Where OpenVDB writes 36 characters that shall be of this file alone.
constexpr std::size_t kUuidBegin = 8 + 4 + 4 + 4 + 1, kUuidLength = 36;

std::uint64_t tableSum(std::span<const std::uint64_t> sums, const Footer& footer) {
    std::vector<std::uint64_t> all(sums.begin(), sums.end());
    all.push_back(footer.size);
    all.push_back(footer.pieceBytes);
    return checksum(std::as_bytes(std::span(all)));
}

/// 32 hexadecimal digits as a UUID has them.
std::string asUuid(std::string digits) {
    for (const std::size_t place : {8u, 13u, 18u, 23u}) digits.insert(place, 1, '-');
    return digits;
}

/// Reads up to `out.size()` bytes. @throws Error naming the file
std::size_t readAt(int file, const std::filesystem::path& path, std::uint64_t offset,
                   std::span<std::byte> out) {
    std::size_t done = 0;
    while (done < out.size()) {
        const ssize_t count =
            pread(file, out.data() + done, out.size() - done, static_cast<off_t>(offset + done));
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) throwFileError(path, std::string("cannot be read: ") + std::strerror(errno));
        if (count == 0) break;
        done += static_cast<std::size_t>(count);
    }
    return done;
}

}  // namespace

void sealFile(AtomicFile& file) {
    const std::uint64_t size = file.position();
    std::vector<std::byte> room(kChecksumBytes);
    std::vector<std::uint64_t> sums;
    const auto sumAt = [&](std::uint64_t offset) {
        const auto bytes = std::span(room).first(std::min(kChecksumBytes, size - offset));
        file.seek(offset);
        file.read(bytes.data(), bytes.size());
        return checksum(bytes);
    };
    // The identifier is a hash of all other bytes, so that equal caches are equal files.
    const auto setUuid = [&](const std::string& text) {
        file.seek(kUuidBegin);
        file.write(text.data(), kUuidLength);
    };
    setUuid(std::string(kUuidLength, '0'));
    for (std::uint64_t offset = 0; offset < size; offset += kChecksumBytes)
        sums.push_back(sumAt(offset));
    ContentHash hash;
    hash.add(std::as_bytes(std::span(sums)));
    setUuid(asUuid(hash.text()));
    sums[0] = sumAt(0);
    Footer footer{size, kChecksumBytes, 0, {}};
    std::ranges::copy(kMagic, footer.magic.begin());
    footer.tableSum = tableSum(sums, footer);
    file.seek(size);
    file.write(sums.data(), sums.size() * sizeof sums[0]);
    file.write(&footer, sizeof footer);
}

std::optional<CheckedFile> CheckedFile::open(const std::filesystem::path& path) {
    CheckedFile file(path, ::open(path.c_str(), O_RDONLY | O_CLOEXEC));
    struct stat status {};
    if (file.file_ < 0 || fstat(file.file_, &status) != 0)
        throwFileError(path, std::string("cannot be opened: ") + std::strerror(errno));
    if (!file.readTable(static_cast<std::uint64_t>(status.st_size))) return std::nullopt;
    return file;
}

CheckedFile::~CheckedFile() {
    if (file_ >= 0) close(file_);
}

CheckedFile::CheckedFile(CheckedFile&& other) noexcept
    : path_(std::move(other.path_)),
      file_(std::exchange(other.file_, -1)),
      size_(other.size_),
      sums_(std::move(other.sums_)) {}

bool CheckedFile::readTable(std::uint64_t fileSize) {
    Footer footer{};
    if (fileSize < sizeof footer) return false;
    readAt(file_, path_, fileSize - sizeof footer, std::as_writable_bytes(std::span(&footer, 1)));
    if (std::string_view(footer.magic.data(), footer.magic.size()) != kMagic ||
        footer.pieceBytes != kChecksumBytes || footer.size > fileSize)
        return false;
    const std::uint64_t count = (footer.size + kChecksumBytes - 1) / kChecksumBytes;
    if (footer.size + count * sizeof(std::uint64_t) + sizeof footer != fileSize) return false;
    sums_.resize(count);
    readAt(file_, path_, footer.size, std::as_writable_bytes(std::span(sums_)));
    size_ = footer.size;
    return tableSum(sums_, footer) == footer.tableSum;
}

/// Bytes of a piece; empty if they differ from their checksum.
std::span<const std::byte> CheckedFile::piece(std::size_t number,
                                              std::vector<std::byte>& room) const {
    const std::uint64_t begin = number * kChecksumBytes;
    room.resize(std::min<std::uint64_t>(kChecksumBytes, size_ - begin));
    const std::size_t count = readAt(file_, path_, begin, room);
    if (count < room.size())
        throwFileError(path_,
                       fmt::format("cut short while it was in use: {} bytes are missing at {}",
                                   room.size() - count, begin + count));
    if (checksum(room) != sums_[number]) return {};
    return room;
}

std::size_t CheckedFile::read(std::uint64_t offset, std::span<std::byte> out) const {
    std::vector<std::byte> room;
    std::size_t done = 0;
    while (done < out.size() && offset + done < size_) {
        const std::size_t number = (offset + done) / kChecksumBytes;
        const std::span<const std::byte> bytes = piece(number, room);
        if (bytes.empty())
            throwFileError(
                path_, fmt::format("damaged: bytes {} to {} differ from their checksum",
                                   number * kChecksumBytes, number * kChecksumBytes + room.size()));
        const auto wanted = bytes.subspan((offset + done) % kChecksumBytes);
        const std::size_t count = std::min(wanted.size(), out.size() - done);
        std::copy_n(wanted.begin(), count, out.begin() + static_cast<std::ptrdiff_t>(done));
        done += count;
    }
    return done;
}

std::vector<std::uint64_t> CheckedFile::damaged() const {
    constexpr std::size_t kPiecesAtOnce = 64;
    std::vector<std::uint8_t> bad(sums_.size(), 0);
    parallelFor(sums_.size(), kPiecesAtOnce, [&](const Chunk& chunk) {
        std::vector<std::byte> room;
        for (std::size_t i = chunk.begin; i < chunk.end; ++i) bad[i] = piece(i, room).empty();
    });
    std::vector<std::uint64_t> begins;
    for (std::size_t i = 0; i < bad.size(); ++i)
        if (bad[i]) begins.push_back(i * kChecksumBytes);
    return begins;
}

std::string contentName(const CheckedFile& file) {
    std::string name(kUuidLength, '\0');
    file.read(kUuidBegin, std::as_writable_bytes(std::span(name)));
    return name;
}

CheckedBuffer::int_type CheckedBuffer::underflow() {
    const std::uint64_t at = position();
    // To the end of a piece, so that each is read once.
    const std::size_t count = file_.read(
        at, std::as_writable_bytes(std::span(room_).first(kChecksumBytes - at % kChecksumBytes)));
    begin_ = at;
    setg(room_.data(), room_.data(), room_.data() + count);
    return count == 0 ? traits_type::eof() : traits_type::to_int_type(room_[0]);
}

CheckedBuffer::pos_type CheckedBuffer::seekoff(off_type offset, std::ios_base::seekdir from,
                                               std::ios_base::openmode mode) {
    const auto base = from == std::ios_base::beg   ? off_type{0}
                      : from == std::ios_base::cur ? static_cast<off_type>(position())
                                                   : static_cast<off_type>(file_.size());
    return seekpos(pos_type(base + offset), mode);
}

CheckedBuffer::pos_type CheckedBuffer::seekpos(pos_type position, std::ios_base::openmode) {
    const auto to = off_type(position);
    if (to < 0) return pos_type(off_type(-1));
    const auto wanted = static_cast<std::uint64_t>(to);
    if (wanted >= begin_ && wanted <= begin_ + static_cast<std::uint64_t>(egptr() - eback()))
        setg(eback(), eback() + (wanted - begin_), egptr());
    else {
        begin_ = wanted;
        setg(room_.data(), room_.data(), room_.data());
    }
    return position;
}

}  // namespace shadowcache
