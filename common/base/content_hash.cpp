#include "common/base/content_hash.h"

#include <fmt/core.h>
#define XXH_INLINE_ALL  // compiled in, for the processor that the program is built for
#include <xxhash.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>
#include <vector>

#include "common/base/error.h"
#include "common/base/file_bytes.h"

namespace shadowcache {

struct ContentHash::State {
    alignas(64) XXH3_state_t hash;
};

std::uint64_t checksum(std::span<const std::byte> bytes) noexcept {
    return XXH3_64bits(bytes.data(), bytes.size());
}

std::uint64_t checksum(std::string_view bytes) noexcept {
    return checksum(std::as_bytes(std::span(bytes)));
}

std::string sealed(std::string bytes) {
    const std::uint64_t sum = checksum(bytes);
    return std::move(bytes.append(reinterpret_cast<const char*>(&sum), sizeof sum));
}

std::optional<std::string_view> unsealed(std::string_view bytes) noexcept {
    std::uint64_t sum = 0;
    if (bytes.size() < sizeof sum) return std::nullopt;
    std::memcpy(&sum, bytes.data() + bytes.size() - sizeof sum, sizeof sum);
    bytes.remove_suffix(sizeof sum);
    if (checksum(bytes) != sum) return std::nullopt;
    return bytes;
}

ContentHash::ContentHash() : state_(std::make_unique<State>()) {
    XXH3_128bits_reset(&state_->hash);
}
ContentHash::~ContentHash() = default;
ContentHash::ContentHash(ContentHash&&) noexcept = default;

void ContentHash::add(std::span<const std::byte> bytes) {
    XXH3_128bits_update(&state_->hash, bytes.data(), bytes.size());
}

void ContentHash::addText(std::string_view text) {
    const std::uint64_t length = text.size();
    add(std::as_bytes(std::span(&length, 1)));
    add(std::as_bytes(std::span(text)));
}

std::string ContentHash::text() const {
    const XXH128_hash_t hash = XXH3_128bits_digest(&state_->hash);
    return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

std::string contentHash(const std::filesystem::path& path) {
    requireReadableFile(path);
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"),
                                                               std::fclose);
    if (!file) throwFileError(path, std::string("cannot be opened: ") + std::strerror(errno));
    ContentHash hash;
    std::vector<std::byte> bytes(std::size_t{1} << 20);
    for (;;) {
        const std::size_t count = std::fread(bytes.data(), 1, bytes.size(), file.get());
        hash.add(std::span(bytes).first(count));
        if (count < bytes.size()) break;
    }
    if (std::ferror(file.get())) throwFileError(path, "cannot be read");
    return hash.text();
}

}  // namespace shadowcache
