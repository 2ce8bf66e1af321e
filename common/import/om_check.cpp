#include "common/import/om_check.h"

#include <fmt/core.h>

#include <array>
#include <cstring>
#include <string>

#include "common/base/error.h"

namespace shadowcache {

namespace {

constexpr std::size_t kOmHeaderBytes = 16;

enum Entity { kVertex = 0, kFace = 2, kHalfedge = 6, kEnd = 7 };
enum Type { kPosition = 0, kNormal = 1, kTexcoord = 2, kColor = 4, kTopology = 7 };

/// The 16 bits before a chunk's data.
struct ChunkHeader {
    unsigned bits;

    bool named() const { return (bits >> 1 & 1) != 0; }
    unsigned entity() const { return bits >> 2 & 7; }
    unsigned type() const { return bits >> 5 & 15; }
    unsigned dimensions() const { return (bits >> 11 & 7) + 1; }
    unsigned integerBytes() const { return 1u << (bits >> 14); }
    unsigned floatBytes() const { return 4u << (bits >> 14); }
};

std::string versionText(unsigned version) {
    return fmt::format("{}.{}", version >> 5, version & 31);
}

class Walk {
public:
    Walk(const std::filesystem::path& path, std::string_view bytes) : path_(path), bytes_(bytes) {
        std::memcpy(counts_.data(), bytes.data() + 4, sizeof counts_);
        found_.vertices = counts_[0];
        found_.faces = counts_[1];
    }

    OmCounts run() {
        while (at_ < bytes_.size()) {
            const ChunkHeader chunk{number(2)};
            if (chunk.entity() == kEnd) return found_;
            skipChunk(chunk);
        }
        // Files of version 1 may end without the mark.
        if (major() >= 2) truncated();
        return found_;
    }

private:
    unsigned major() const { return static_cast<unsigned char>(bytes_[3]) >> 5; }

    [[noreturn]] void truncated() const {
        throwFileError(path_,
                       fmt::format("truncated: {} bytes do not hold its {} vertices and {} faces",
                                   bytes_.size(), counts_[0], counts_[1]));
    }

    unsigned number(std::size_t size) {
        if (bytes_.size() - at_ < size) truncated();
        std::uint16_t value = 0;
        std::memcpy(&value, bytes_.data() + at_, size);
        at_ += size;
        return value;
    }

    void skip(std::uint64_t count, std::uint64_t itemBytes) {
        if (count * itemBytes > bytes_.size() - at_) truncated();
        at_ += static_cast<std::size_t>(count * itemBytes);
    }

    void skipChunk(const ChunkHeader& chunk) {
        const bool vector = chunk.floatBytes() <= 8 && chunk.dimensions() == 3 &&
                            (chunk.type() == kPosition || chunk.type() == kNormal);
        const std::uint64_t vertices = counts_[0];
        const std::uint64_t faces = counts_[1];
        const std::uint64_t edges = counts_[2];
        const bool topology = chunk.type() == kTopology && chunk.integerBytes() <= 4;
        if (chunk.named()) refuse(chunk);
        if (chunk.entity() == kVertex && vector) {
            skip(vertices, std::uint64_t{3} * chunk.floatBytes());
        } else if (chunk.entity() == kVertex && chunk.type() == kTexcoord &&
                   chunk.dimensions() == 2 && chunk.floatBytes() == 4) {
            skip(vertices, 8);
            found_.hasTexcoords = true;
        } else if (chunk.entity() == kVertex && isColor(chunk)) {
            skip(vertices, 3);
        } else if (chunk.entity() == kVertex && topology) {
            skip(vertices, chunk.integerBytes());
        } else if (chunk.entity() == kHalfedge && topology) {
            skip(2 * edges, std::uint64_t{3} * chunk.integerBytes());
        } else if (chunk.entity() == kFace && vector && chunk.type() == kNormal) {
            skip(faces, std::uint64_t{3} * chunk.floatBytes());
        } else if (chunk.entity() == kFace && isColor(chunk)) {
            skip(faces, 3);
            found_.hasFaceColors = true;
        } else if (chunk.entity() == kFace && topology) {
            skipFaces(chunk);
        } else {
            refuse(chunk);
        }
    }

    static bool isColor(const ChunkHeader& chunk) {
        return chunk.type() == kColor && chunk.dimensions() == 3 && chunk.integerBytes() == 1;
    }

    [[noreturn]] void refuse(const ChunkHeader& chunk) const {
        throwFileError(path_, fmt::format("OM chunk of kind {}{}, expected positions, normals, "
                                          "colours, texture coordinates or topology",
                                          chunk.bits, chunk.named() ? " with a name" : ""));
    }

    /// One half-edge each; before version 2 all corners, after their number if that may differ.
    void skipFaces(const ChunkHeader& chunk) {
        const char mesh = bytes_[2];
        if (major() >= 2) {
            skip(counts_[1], chunk.integerBytes());
        } else if (mesh == 'P') {
            for (std::uint32_t i = 0; i < counts_[1]; ++i) skip(number(2), chunk.integerBytes());
        } else {
            skip(counts_[1], std::uint64_t{mesh == 'T' ? 3u : 4u} * chunk.integerBytes());
        }
    }

    const std::filesystem::path& path_;
    std::string_view bytes_;
    std::size_t at_ = kOmHeaderBytes;
    std::array<std::uint32_t, 3> counts_{};  ///< vertices, faces, edges
    OmCounts found_;
};

}  // namespace

OmCounts checkOm(const std::filesystem::path& path, std::string_view bytes,
                 std::uint8_t newestVersion) {
    if (!bytes.starts_with("OM"))
        throwFileError(path, "does not start with 'OM', expected an OM file");
    if (bytes.size() < kOmHeaderBytes) throwFileError(path, "truncated: ends within the header");
    if (bytes[2] != 'T' && bytes[2] != 'Q' && bytes[2] != 'P') {
        throwFileError(path, fmt::format("OM mesh kind {}, expected T, Q or P", int{bytes[2]}));
    }
    const auto version = static_cast<std::uint8_t>(bytes[3]);
    if (version > newestVersion) {
        throwFileError(path, "OM version " + versionText(version) + ", expected at most " +
                                 versionText(newestVersion));
    }
    return Walk(path, bytes).run();
}

}  // namespace shadowcache
