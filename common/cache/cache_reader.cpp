#include <openvdb/io/File.h>
#include <openvdb/io/GridDescriptor.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <system_error>

#include "common/base/error.h"
#include "common/cache/cache_grids.h"
#include "common/cache/cache_items.h"
#include "common/cache/grid_leaves.h"
#include "common/cache/vdb_archive.h"

namespace shadowcache {

namespace {

namespace fs = std::filesystem;

template <class T>
T metaValue(const openvdb::MetaMap& meta, const char* key, const fs::path& path) {
    const auto value = meta.getMetadata<openvdb::TypedMetadata<T>>(key);
    if (!value)
        throwFileError(path, std::string("a shadow cache without its metadata '") + key + "'");
    return value->value();
}

CacheHeader fromMetadata(const openvdb::MetaMap& meta, const fs::path& path) {
    if (!meta[kFormatKey])
        throwFileError(path, "an OpenVDB file, but not a shadow cache (no 'shadowcache_format')");
    const auto format = metaValue<std::int32_t>(meta, kFormatKey, path);
    if (format != kCacheFormat)
        throwFileError(path, "cache format " + std::to_string(format) + ", this program reads " +
                                 std::to_string(kCacheFormat) +
                                 (format > kCacheFormat ? " (written by a newer version)" : ""));
    CacheHeader header;
    header.level = metaValue<std::int32_t>(meta, "level", path);
    header.adaptive = metaValue<bool>(meta, "adaptive", path);
    header.spacing = metaValue<double>(meta, "spacing", path);
    header.rays = metaValue<std::int32_t>(meta, "rays", path);
    header.seeds = metaValue<std::string>(meta, "seeds", path);
    header.upAxis = metaValue<std::string>(meta, "up_axis", path);
    header.unit = metaValue<double>(meta, "unit", path);
    header.version = metaValue<std::string>(meta, "version", path);
    if (meta["shots"]) {
        const auto count = [&](const char* key) {
            return static_cast<std::uint64_t>(metaValue<std::int64_t>(meta, key, path));
        };
        header.part = {count("sides"), count("sides_of_set"),
                       metaValue<std::string>(meta, "shots", path)};
    }
    const auto print = metaValue<std::string>(meta, "fingerprint", path);
    const auto parsed =
        std::from_chars(print.data(), print.data() + print.size(), header.fingerprint, 16);
    if (parsed.ec != std::errc() || parsed.ptr != print.data() + print.size())
        throwFileError(path, "fingerprint '" + print + "', expected 16 hexadecimal digits");
    if (header.level < 0 || header.level > kMaxCacheLevel)
        throwFileError(path,
                       "direction level " + std::to_string(header.level) + ", expected 0 to 5");
    if (!(header.spacing > 0))
        throwFileError(path, "spacing " + std::to_string(header.spacing) + ", expected above 0");
    return header;
}

template <class Grid>
typename Grid::Ptr takeGrid(openvdb::io::File& file, const char* name, const fs::path& path) {
    if (!file.hasGrid(name)) throwFileError(path, std::string("no grid '") + name + "'");
    const auto grid = openvdb::gridPtrCast<Grid>(file.readGrid(name));
    if (!grid) throwFileError(path, std::string("grid '") + name + "' is of another type");
    return grid;
}

/// Refuses a file shorter than its header states, before OpenVDB takes what lies behind its end for
/// sizes.
void requireWhole(const fs::path& path) {
    // The library keeps this table to itself: magic number, file and library versions, a flag for
    // offsets, 36 characters of UUID, metadata, then a descriptor of every grid before its data.
    std::ifstream in(path, std::ios::binary);
    const auto number = [&](auto value) {
        in.read(reinterpret_cast<char*>(&value), sizeof value);
        return value;
    };
    if (number(std::int64_t{0}) != openvdb::OPENVDB_MAGIC || !in)
        throwFileError(path, "not an OpenVDB file");
    const auto size = static_cast<std::int64_t>(fs::file_size(path));
    in.exceptions(std::ios::failbit | std::ios::badbit);
    try {
        const auto format = number(std::uint32_t{0});
        if (format > openvdb::OPENVDB_FILE_VERSION) return;  // the library's own message is better
        const auto major = number(std::uint32_t{0}), minor = number(std::uint32_t{0});
        openvdb::io::setVersion(in, {major, minor}, format);
        in.seekg(1 + 36, std::ios::cur);
        openvdb::MetaMap().readMeta(in);
        for (auto count = number(std::int32_t{0}); count > 0; --count) {
            openvdb::io::GridDescriptor grid;
            grid.read(in);
            if (grid.getEndPos() < in.tellg() || grid.getEndPos() > size) in.setstate(in.failbit);
            in.seekg(grid.getEndPos());
        }
    } catch (const std::ios::failure&) {
        throwFileError(path, "cut short: " + std::to_string(size) + " bytes do not hold its grids");
    }
}

/// Opens a cache file for `read`, and reports what is wrong with it in our own words.
template <class Read>
auto withCacheFile(const fs::path& path, const Read& read) {
    initializeOpenVdb();
    std::error_code ignored;
    if (!fs::exists(path, ignored)) throwFileError(path, "no such file");
    if (fs::is_directory(path, ignored)) throwFileError(path, "a directory, expected a cache file");
    if (fs::file_size(path, ignored) == 0) throwFileError(path, "empty, expected a cache file");
    try {
        requireWhole(path);
        openvdb::io::File file(path.string());
        file.setCopyMaxBytes(0);
        file.open(false);
        const openvdb::MetaMap::Ptr meta = file.getMetadata();  // a fresh copy: keep it alive
        return read(file, fromMetadata(*meta, path));
    } catch (const openvdb::Exception& e) {
        throwFileError(path,
                       std::string("not a readable OpenVDB file, or cut short (") + e.what() + ")");
    } catch (const std::bad_alloc&) {
        throwFileError(path, "cut short or damaged (it asks for more memory than there is)");
    }
}

/// Appends the items of one leaf in the order of their voxels, and their blocks.
void appendLeaf(const openvdb::Coord& origin, const LeafView& leaf, std::size_t baseCells,
                CacheItems& items) {
    const auto row = [](std::vector<std::uint8_t>& out, const std::uint8_t* counts,
                        std::size_t cells) { out.insert(out.end(), counts, counts + cells); };
    std::uint32_t i = 0;
    for (openvdb::Index v = 0; v < kLeafVoxels; ++v) {
        const openvdb::Coord voxel = origin + PointLeaf::offsetToLocalCoord(v);
        for (; i < leaf.voxelEnd[v]; ++i) {
            items.voxel.emplace_back(voxel.x(), voxel.y(), voxel.z());
            items.patch.push_back(leaf.patch[i]);
            items.normal.push_back(leaf.normal[i]);
            items.position.push_back(leaf.position[i]);
            row(items.n, leaf.n.row(i), baseCells);
            row(items.d, leaf.d.row(i), baseCells);
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

}  // namespace

CacheGrids readGrids(const fs::path& path) {
    return withCacheFile(path, [&](openvdb::io::File& file, const CacheHeader& header) {
        CacheGrids grids{header, {}, {}};
        grids.items = takeGrid<PointGrid>(file, kItemGrid, path);
        grids.blocks = takeGrid<PointGrid>(file, kBlockGrid, path);
        return grids;
    });
}

CacheHeader readHeader(const fs::path& path) {
    return withCacheFile(
        path, [](const openvdb::io::File&, const CacheHeader& header) { return header; });
}

CacheItems readCache(const fs::path& path, CacheHeader& header) {
    const CacheGrids grids = readGrids(path);
    header = grids.header;
    const DirectionTiers tiers = header.tiers();
    CacheItems items;
    // OpenVDB's tree has larger nodes above the leaves, and visits them one by one.
    std::vector<PointLeaf*> leaves;
    for (auto leaf = grids.items->tree().beginLeaf(); leaf; ++leaf) leaves.push_back(&*leaf);
    std::ranges::sort(
        leaves, [](const PointLeaf* a, const PointLeaf* b) { return a->origin() < b->origin(); });
    for (PointLeaf* leaf : leaves)
        appendLeaf(leaf->origin(),
                   viewOf(*leaf, grids.blocks->tree().probeLeaf(leaf->origin()), tiers, path),
                   tiers.baseCells(), items);
    return items;
}

}  // namespace shadowcache
