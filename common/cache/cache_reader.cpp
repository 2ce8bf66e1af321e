#include <fmt/core.h>
#include <openvdb/io/File.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/io/io.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <functional>
#include <map>
#include <optional>
#include <stdexcept>
#include <system_error>
#include <tuple>

#include "common/base/error.h"
#include "common/cache/cache_grids.h"
#include "common/cache/cache_header_file.h"
#include "common/cache/cache_items.h"
#include "common/cache/grid_leaves.h"
#include "common/cache/open_cache.h"
#include "common/cache/vdb_archive.h"

namespace shadowcache {

namespace {

namespace fs = std::filesystem;

template <class Grid>
typename Grid::Ptr takeGrid(openvdb::io::File& file, const char* name, const fs::path& path) {
    if (!file.hasGrid(name)) throwFileError(path, std::string("no grid '") + name + "'");
    const auto grid = openvdb::gridPtrCast<Grid>(file.readGrid(name));
    if (!grid) throwFileError(path, std::string("grid '") + name + "' is of another type");
    return grid;
}

/// What a file states before its data.
struct FileHead {
    openvdb::MetaMap metadata;
    std::vector<openvdb::io::GridDescriptor> grids;  ///< in the file's order
};

/// Bytes of a metadata value of a type; none if its length says.
std::optional<std::uint32_t> fixedLength(const std::string& type) {
    static const std::map<std::string, std::uint32_t, std::less<>> kLengths{
        {"bool", 1},   {"int32", 4},  {"int64", 8},   {"float", 4},  {"double", 8}, {"vec2d", 16},
        {"vec2i", 8},  {"vec2s", 8},  {"vec3d", 24},  {"vec3i", 12}, {"vec3s", 12}, {"vec4d", 32},
        {"vec4i", 16}, {"vec4s", 16}, {"mat4d", 128}, {"mat4s", 64}};
    const auto found = kLengths.find(type);
    return found == kLengths.end() ? std::nullopt : std::optional(found->second);
}

/// Fails the stream where metadata, or the texts of a grid, do not fit into the file's `size`;
/// comes back to where it was. OpenVDB makes room for a text before it reads it.
class FitCheck {
public:
    FitCheck(std::istream& in, std::uint64_t size) : in_(in), size_(size), begin_(in.tellg()) {}

    void metadata() {
        for (auto count = number(); count > 0; --count) {
            skip(number());
            std::string type(room(number()), '\0');
            in_.read(type.data(), static_cast<std::streamsize>(type.size()));
            const std::uint32_t length = number();
            // OpenVDB goes by the type.
            if (length != fixedLength(type).value_or(length)) in_.setstate(in_.failbit);
            skip(length);
        }
        in_.seekg(begin_);
    }
    void grid() {
        for (int text = 0; text < 3; ++text) skip(number());
        in_.seekg(begin_);
    }

private:
    std::uint32_t number() {
        std::uint32_t value = 0;
        in_.read(reinterpret_cast<char*>(&value), sizeof value);
        return value;
    }
    std::uint32_t room(std::uint32_t length) {
        const auto at = static_cast<std::uint64_t>(in_.tellg());
        if (length > size_ - std::min(at, size_)) in_.setstate(in_.failbit);
        return length;
    }
    void skip(std::uint32_t length) { in_.seekg(room(length), std::ios::cur); }

    std::istream& in_;
    std::uint64_t size_;
    std::istream::pos_type begin_;
};

/// Reads a file's metadata, and refuses a file shorter than its table of grids states, before
/// OpenVDB takes what lies behind its end for sizes.
FileHead readHead(std::istream& in, std::uint64_t size, const fs::path& path) {
    // The library keeps this table to itself: magic number, file and library versions, a flag for
    // offsets, 36 characters of UUID, metadata, then a descriptor of every grid before its data.
    const auto number = [&](auto value) {
        in.read(reinterpret_cast<char*>(&value), sizeof value);
        return value;
    };
    if (number(std::int64_t{0}) != openvdb::OPENVDB_MAGIC || !in)
        throwFileError(path, "not an OpenVDB file");
    in.exceptions(std::ios::failbit | std::ios::badbit);
    FileHead head;
    try {
        const auto format = number(std::uint32_t{0});
        if (format > openvdb::OPENVDB_FILE_VERSION)
            throwFileError(path, fmt::format("version {} of OpenVDB's format, expected at most {}",
                                             format, openvdb::OPENVDB_FILE_VERSION));
        const auto major = number(std::uint32_t{0}), minor = number(std::uint32_t{0});
        openvdb::io::setVersion(in, {major, minor}, format);
        in.seekg(1 + 36, std::ios::cur);
        FitCheck(in, size).metadata();
        head.metadata.readMeta(in);
        for (auto count = number(std::int32_t{0}); count > 0; --count) {
            openvdb::io::GridDescriptor& grid = head.grids.emplace_back();
            FitCheck(in, size).grid();
            grid.read(in);
            const auto end = static_cast<std::uint64_t>(grid.getEndPos());
            if (end < static_cast<std::uint64_t>(in.tellg()) || end > size) in.setstate(in.failbit);
            in.seekg(grid.getEndPos());
        }
    } catch (const std::ios::failure&) {
        throwFileError(path, fmt::format("cut short: {} bytes do not hold its grids", size));
    }
    return head;
}

/// Most of what OpenVDB says of a file that is told. [bytes]
constexpr std::size_t kMostReason = 300;

/// What is wrong with a file without sound checksums. Nothing of it is decoded but its metadata.
[[noreturn]] void refuseUnchecked(const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    fromMetadata(readHead(in, fs::file_size(path), path).metadata, path);
    throwFileError(path, "cut short or damaged: its checksums are missing, or not whole");
}

/// What OpenVDB and the standard library make of a damaged file, in our own words.
template <class Read>
auto withReadErrors(const fs::path& path, const Read& read) {
    try {
        return read();
    } catch (const openvdb::Exception& e) {
        // It quotes names from the file, which may claim to have gigabytes.
        const std::string reason(e.what(), ::strnlen(e.what(), kMostReason));
        throwFileError(path, "not a readable OpenVDB file, or cut short (" + reason + ")");
    } catch (const std::bad_alloc&) {
        throwFileError(path, "cut short or damaged (it asks for more memory than there is)");
    } catch (const std::length_error&) {
        throwFileError(path, "cut short or damaged (it asks for more memory than there is)");
    }
}

}  // namespace

CheckedFile openChecked(const fs::path& path) {
    initializeOpenVdb();
    std::error_code ignored;
    if (!fs::exists(path, ignored)) throwFileError(path, "no such file");
    if (fs::is_directory(path, ignored)) throwFileError(path, "a directory, expected a cache file");
    if (!fs::is_regular_file(path, ignored))
        throwFileError(path, "has no known size, expected a cache file");
    if (fs::file_size(path, ignored) == 0) throwFileError(path, "empty, expected a cache file");
    if (std::optional<CheckedFile> file = CheckedFile::open(path)) return *std::move(file);
    withReadErrors(path, [&] { refuseUnchecked(path); });
    std::abort();  // refuseUnchecked() does not return
}

namespace {

FileHead readHead(const CheckedFile& file) {
    return withReadErrors(file.path(), [&] {
        CheckedBuffer buffer(file);
        std::istream in(&buffer);
        // So that the file's own Error comes through.
        in.exceptions(std::ios::badbit);
        return readHead(in, file.size(), file.path());
    });
}

/// "in grid 'openness'", or where else a byte is.
std::string placeText(const FileHead& head, std::uint64_t begin) {
    const std::uint64_t end = begin + kChecksumBytes;
    std::string text;
    for (const auto& grid : head.grids)
        if (static_cast<std::uint64_t>(grid.getGridPos()) < end &&
            begin < static_cast<std::uint64_t>(grid.getEndPos()))
            text += (text.empty() ? " in grid '" : "', '") + grid.gridName();
    return text.empty() ? text : text + "'";
}

/// @throws Error naming the file and the places that differ from their checksums
void requireWhole(const CheckedFile& file, const FileHead& head) {
    const std::vector<std::uint64_t> begins = file.damaged();
    if (begins.empty()) return;
    std::string places;
    constexpr std::size_t kShown = 3;
    for (std::size_t i = 0; i < std::min(begins.size(), kShown); ++i)
        places += fmt::format("{}{}{}", i ? ", at " : "at ", begins[i], placeText(head, begins[i]));
    if (begins.size() > kShown) places += ", ...";
    throwFileError(
        file.path(),
        fmt::format("damaged: {} of {} pieces of {} bytes differ from their checksums: {}",
                    begins.size(), file.pieces(), kChecksumBytes, places));
}

}  // namespace

CacheHeader readHeader(const CheckedFile& file) {
    return fromMetadata(readHead(file).metadata, file.path());
}

namespace {

/// Appends the items of one leaf in the order of their voxels, and their blocks.
void appendLeaf(const Vec3i& origin, const LeafView& leaf, std::size_t baseCells,
                CacheItems& items) {
    const auto row = [](auto& out, const auto* values, std::size_t count) {
        out.insert(out.end(), values, values + count);
    };
    std::uint32_t i = 0;
    for (std::uint32_t v = 0; v < kLeafVoxels; ++v) {
        const Vec3i voxel = origin + voxelInLeaf(v);
        for (; i < leaf.voxelEnd[v]; ++i) {
            items.voxel.push_back(voxel);
            items.patch.push_back(leaf.patch[i]);
            items.normal.push_back(leaf.normal[i]);
            items.position.push_back(leaf.position[i]);
            row(items.n, leaf.n.row(i), baseCells);
            row(items.d, leaf.d.row(i), baseCells);
            row(items.hits, leaf.hits + std::size_t{i} * leaf.hitsPerItem, leaf.hitsPerItem);
            row(items.emitters, leaf.emitters + std::size_t{i} * leaf.emittersPerItem,
                leaf.emittersPerItem);
            const auto first = static_cast<std::size_t>(leaf.firstBlock[i]);
            const auto count = static_cast<std::size_t>(leaf.blockCount[i]);
            for (std::size_t b = first; b < first + count; ++b) {
                CountBlock block{static_cast<std::uint16_t>(leaf.blockKeys[b]), {}, {}};
                std::copy_n(leaf.blockN.row(b), kBlockCells, block.n.begin());
                std::copy_n(leaf.blockD.row(b), kBlockCells, block.d.begin());
                items.blocks.push_back(block);
            }
            items.firstBlock.push_back(static_cast<std::uint32_t>(items.blocks.size()));
        }
    }
}

using PlacedLeaf = std::pair<Vec3i, LeafView>;

/// OpenVDB's tree has larger nodes above the leaves, and visits them one by one.
CacheItems inFileOrder(std::vector<PlacedLeaf> leaves, const CacheHeader& header) {
    std::ranges::sort(leaves, {}, [](const PlacedLeaf& leaf) {
        return std::tuple(leaf.first.x, leaf.first.y, leaf.first.z);
    });
    CacheItems items;
    for (const auto& [origin, leaf] : leaves)
        appendLeaf(origin, leaf, header.tiers().baseCells(), items);
    return items;
}

}  // namespace

CacheGrids readGrids(const fs::path& path) {
    const CheckedFile checked = openChecked(path);
    const FileHead head = readHead(checked);
    CacheGrids grids{fromMetadata(head.metadata, path), {}, {}};
    requireWhole(checked, head);
    withReadErrors(path, [&] {
        openvdb::io::File file(path.string());
        file.setCopyMaxBytes(0);
        file.open(false);
        grids.items = takeGrid<PointGrid>(file, kItemGrid, path);
        grids.blocks = takeGrid<PointGrid>(file, kBlockGrid, path);
    });
    return grids;
}

CacheCheck verifyCache(const fs::path& path) {
    CacheCheck check;
    check.items = readCache(path, check.header).size();
    const CheckedFile file = openChecked(path);
    check.checksums = file.pieces();
    check.bytes = fs::file_size(path);
    return check;
}

CacheHeader readHeader(const fs::path& path) {
    return readHeader(openChecked(path));
}

CacheItems readCache(const fs::path& path, CacheHeader& header) {
    const CacheGrids grids = readGrids(path);
    header = grids.header;
    std::vector<PlacedLeaf> leaves;
    for (auto leaf = grids.items->tree().beginLeaf(); leaf; ++leaf)
        leaves.emplace_back(
            toVoxel(leaf->origin()),
            viewOf(*leaf, grids.blocks->tree().probeLeaf(leaf->origin()), header, path));
    return inFileOrder(std::move(leaves), header);
}

CacheItems itemsOf(const ShadowCache& cache) {
    std::vector<PlacedLeaf> leaves;
    OpenCache::visitLeaves(cache, true, [&](const Vec3i& origin, const LeafView& leaf) {
        leaves.emplace_back(origin, leaf);
    });
    return inFileOrder(std::move(leaves), cache.header());
}

}  // namespace shadowcache
