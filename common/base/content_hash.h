#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace shadowcache {

/// 64 bits that differ, in practice always, where bytes differ; the same on every machine. Against
/// accidents, not against forgery. [XXH3, https://github.com/Cyan4973/xxHash]
std::uint64_t checksum(std::span<const std::byte> bytes) noexcept;
std::uint64_t checksum(std::string_view bytes) noexcept;

/// Bytes with their checksum behind them.
std::string sealed(std::string bytes);
/// What was sealed, without the checksum; nothing if it was cut or changed since.
std::optional<std::string_view> unsealed(std::string_view bytes) noexcept;

/// Hash of a content that is met in pieces: 128 bits, so that two contents of one hash are not met
/// with. It does not depend on how the content is cut into pieces.
class ContentHash {
public:
    ContentHash();
    ~ContentHash();
    ContentHash(ContentHash&&) noexcept;

    void add(std::span<const std::byte> bytes);
    /// The text with its length before it, so that "ab", "c" is not "a", "bc".
    void addText(std::string_view text);
    /// 32 hexadecimal digits, of all that was added so far.
    std::string text() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// ContentHash of a file's bytes: the same for any copy of it, whatever its name and date.
///
/// @throws Error naming the file if it cannot be read
std::string contentHash(const std::filesystem::path& path);

}  // namespace shadowcache
