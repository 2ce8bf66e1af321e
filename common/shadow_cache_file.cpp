#include <openvdb/io/File.h>
#include <openvdb/tree/LeafManager.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <mutex>
#include <system_error>

#include "common/atomic_file.h"
#include "common/cache_grids.h"
#include "common/error.h"
#include "common/parallel.h"

namespace shadowcache {

namespace {

namespace fs = std::filesystem;
using openvdb::points::AttributeSet;
using openvdb::points::PointDataTree;

constexpr const char* kFormatKey = "shadowcache_format";

openvdb::Coord toCoord(const Vec3i& v) {
    return {v.x, v.y, v.z};
}

/// Items [begin, end) of one 8^3 leaf.
struct LeafRange {
    openvdb::Coord origin;
    std::size_t begin, end;
};

std::vector<LeafRange> splitByLeaf(const CacheItems& items) {
    std::vector<LeafRange> leaves;
    for (std::size_t i = 0; i < items.size(); ++i) {
        const openvdb::Coord origin = toCoord(items.voxel[i]) & ~7;
        if (leaves.empty() || leaves.back().origin != origin) leaves.push_back({origin, i, i});
        leaves.back().end = i + 1;
    }
    return leaves;
}

struct AttributeSpec {
    const char* name;
    openvdb::NamePair type;
    openvdb::Index stride;
};

/// A points leaf with `count` points and the attributes that `specs` list after the position "P".
/// `descriptors` holds the chain of descriptors, shared by all leaves.
void initializeLeaf(PointLeaf& leaf, std::size_t count, const std::vector<AttributeSpec>& specs,
                    std::vector<AttributeSet::Descriptor::Ptr>& descriptors) {
    leaf.initializeAttributes(descriptors[0], static_cast<openvdb::Index>(count));
    for (std::size_t k = 0; k < specs.size(); ++k)
        leaf.appendAttribute(*descriptors[k], descriptors[k + 1], k + 1, specs[k].stride, true);
}

std::vector<AttributeSet::Descriptor::Ptr> describe(const std::vector<AttributeSpec>& specs) {
    std::vector<AttributeSet::Descriptor::Ptr> chain{
        AttributeSet::Descriptor::create(VectorArray::attributeType())};
    for (const AttributeSpec& spec : specs)
        chain.push_back(chain.back()->duplicateAppend(spec.name, spec.type));
    return chain;
}

template <class Array>
Array& expanded(PointLeaf& leaf, const char* name) {
    auto& array = Array::cast(leaf.attributeArray(name));
    array.expand();
    return array;
}

/// One voxel's end offset per entry, from the voxel of every point (sorted).
template <class VoxelOf>
void setOffsets(PointLeaf& leaf, std::size_t count, VoxelOf voxelOf) {
    std::vector<PointLeaf::ValueType> offsets(PointLeaf::SIZE, 0);
    std::size_t next = 0;
    for (openvdb::Index v = 0; v < PointLeaf::SIZE; ++v) {
        while (next < count && PointLeaf::coordToOffset(voxelOf(next)) == v) ++next;
        offsets[v] = PointLeaf::ValueType(static_cast<openvdb::Index32>(next));
    }
    leaf.setOffsets(offsets);
}

void fillItemLeaf(PointLeaf& leaf, const LeafRange& range, const CacheItems& items,
                  std::size_t baseCells) {
    setOffsets(leaf, range.end - range.begin,
               [&](std::size_t i) { return toCoord(items.voxel[range.begin + i]); });
    auto& position = expanded<VectorArray>(leaf, "P");
    auto& normal = expanded<VectorArray>(leaf, "normal");
    auto& side = expanded<ByteArray>(leaf, "side");
    auto& n = expanded<ByteArray>(leaf, "n");
    auto& d = expanded<ByteArray>(leaf, "d");
    auto& firstBlock = expanded<IntArray>(leaf, "first_block");
    auto& blockCount = expanded<ShortArray>(leaf, "block_count");
    const std::uint32_t leafBlocks = items.firstBlock[range.begin];
    for (std::size_t i = range.begin; i < range.end; ++i) {
        const auto k = static_cast<openvdb::Index>(i - range.begin);
        const Vec3f& p = items.position[i];
        const Vec3f& v = items.normal[i];
        position.setUnsafe(k, openvdb::Vec3f(p.x, p.y, p.z));
        normal.setUnsafe(k, openvdb::Vec3f(v.x, v.y, v.z));
        side.setUnsafe(k, static_cast<std::int8_t>(items.side[i]));
        firstBlock.setUnsafe(k, static_cast<std::int32_t>(items.firstBlock[i] - leafBlocks));
        blockCount.setUnsafe(
            k, static_cast<std::int16_t>(items.firstBlock[i + 1] - items.firstBlock[i]));
        for (std::size_t c = 0; c < baseCells; ++c) {
            const auto at = static_cast<openvdb::Index>(k * baseCells + c);
            n.setUnsafe(at, static_cast<std::int8_t>(items.n[i * baseCells + c]));
            d.setUnsafe(at, static_cast<std::int8_t>(items.d[i * baseCells + c]));
        }
    }
    n.compact();
    d.compact();
}

void fillBlockLeaf(PointLeaf& leaf, const LeafRange& range, const CacheItems& items) {
    const std::uint32_t first = items.firstBlock[range.begin];
    const std::size_t count = items.firstBlock[range.end] - first;
    std::vector<std::uint32_t> itemOf(count);
    for (std::size_t i = range.begin; i < range.end; ++i)
        std::fill(itemOf.begin() + (items.firstBlock[i] - first),
                  itemOf.begin() + (items.firstBlock[i + 1] - first),
                  static_cast<std::uint32_t>(i));
    setOffsets(leaf, count, [&](std::size_t b) { return toCoord(items.voxel[itemOf[b]]); });
    auto& key = expanded<ShortArray>(leaf, "key");
    auto& n = expanded<ByteArray>(leaf, "n");
    auto& d = expanded<ByteArray>(leaf, "d");
    for (std::size_t b = 0; b < count; ++b) {
        const CountBlock& block = items.blocks[first + b];
        key.setUnsafe(static_cast<openvdb::Index>(b), static_cast<std::int16_t>(block.key));
        for (std::size_t c = 0; c < kBlockCells; ++c) {
            const auto at = static_cast<openvdb::Index>(b * kBlockCells + c);
            n.setUnsafe(at, static_cast<std::int8_t>(block.n[c]));
            d.setUnsafe(at, static_cast<std::int8_t>(block.d[c]));
        }
    }
    d.compact();
}

PointGrid::Ptr makePointGrid(const char* name, double spacing) {
    auto grid = PointGrid::create();
    grid->setName(name);
    grid->setTransform(openvdb::math::Transform::createLinearTransform(spacing));
    return grid;
}

struct PointGrids {
    PointGrid::Ptr items, blocks;
};

PointGrids buildPointGrids(const CacheHeader& header, const CacheItems& items) {
    const auto baseCells = static_cast<openvdb::Index>(header.tiers().baseCells());
    const std::vector<AttributeSpec> itemSpecs{{"normal", VectorArray::attributeType(), 1},
                                               {"side", ByteArray::attributeType(), 1},
                                               {"n", ByteArray::attributeType(), baseCells},
                                               {"d", ByteArray::attributeType(), baseCells},
                                               {"first_block", IntArray::attributeType(), 1},
                                               {"block_count", ShortArray::attributeType(), 1}};
    const std::vector<AttributeSpec> blockSpecs{{"key", ShortArray::attributeType(), 1},
                                                {"n", ByteArray::attributeType(), kBlockCells},
                                                {"d", ByteArray::attributeType(), kBlockCells}};
    auto itemDescriptors = describe(itemSpecs);
    auto blockDescriptors = describe(blockSpecs);
    PointGrids grids{makePointGrid(kItemGrid, header.spacing),
                     makePointGrid(kBlockGrid, header.spacing)};

    const std::vector<LeafRange> leaves = splitByLeaf(items);
    std::vector<PointLeaf*> itemLeaves, blockLeaves;
    for (const LeafRange& range : leaves) {
        itemLeaves.push_back(grids.items->tree().touchLeaf(range.origin));
        initializeLeaf(*itemLeaves.back(), range.end - range.begin, itemSpecs, itemDescriptors);
        const std::size_t blocks = items.firstBlock[range.end] - items.firstBlock[range.begin];
        blockLeaves.push_back(blocks ? grids.blocks->tree().touchLeaf(range.origin) : nullptr);
        if (blocks) initializeLeaf(*blockLeaves.back(), blocks, blockSpecs, blockDescriptors);
    }
    parallelFor(leaves.size(), 16, [&](const Chunk& chunk) {
        for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
            fillItemLeaf(*itemLeaves[i], leaves[i], items, baseCells);
            if (blockLeaves[i]) fillBlockLeaf(*blockLeaves[i], leaves[i], items);
        }
    });
    return grids;
}

/// Grids that any volume tool shows: the open share of the sky above each voxel's surfaces, and
/// where the open part lies on average.
struct VolumeGrids {
    openvdb::FloatGrid::Ptr openness;
    openvdb::Vec3SGrid::Ptr direction;
};

VolumeGrids buildVolumeGrids(const CacheHeader& header, const CacheItems& items) {
    const int level = header.tiers().baseLevel();
    const std::size_t cells = header.tiers().baseCells();
    std::vector<Vec3f> centers;
    for (std::uint32_t c = 0; c < cells; ++c) centers.emplace_back(cellCenter(level, c));
    VolumeGrids grids{openvdb::FloatGrid::create(0.0f), openvdb::Vec3SGrid::create()};
    grids.openness->setName(kOpennessGrid);
    grids.openness->setGridClass(openvdb::GRID_FOG_VOLUME);
    grids.openness->setSaveFloatAsHalf(true);
    grids.direction->setName(kOpenDirectionGrid);
    grids.direction->setVectorType(openvdb::VEC_INVARIANT);
    grids.direction->setSaveFloatAsHalf(true);
    const auto transform = openvdb::math::Transform::createLinearTransform(header.spacing);
    grids.openness->setTransform(transform->copy());
    grids.direction->setTransform(transform->copy());

    auto openness = grids.openness->getAccessor();
    auto direction = grids.direction->getAccessor();
    for (std::size_t i = 0; i < items.size();) {
        const Vec3i voxel = items.voxel[i];
        double open = 0, counted = 0;
        Vec3f sum(0, 0, 0);
        for (; i < items.size() && items.voxel[i] == voxel; ++i)
            for (std::size_t c = 0; c < cells; ++c) {
                const unsigned d = items.d[i * cells + c];
                if (d == 0) continue;
                const float share =
                    static_cast<float>(items.n[i * cells + c]) / static_cast<float>(d);
                open += static_cast<double>(share);
                counted += 1;
                sum += centers[c] * share;
            }
        if (counted == 0) continue;
        openness.setValue(toCoord(voxel), static_cast<float>(open / counted));
        sum /= static_cast<float>(counted);
        direction.setValue(toCoord(voxel), {sum.x, sum.y, sum.z});
    }
    return grids;
}

openvdb::MetaMap toMetadata(const CacheHeader& header, const CacheItems& items) {
    char fingerprint[17];
    std::snprintf(fingerprint, sizeof fingerprint, "%016llx",
                  static_cast<unsigned long long>(header.fingerprint));
    openvdb::MetaMap meta;
    meta.insertMeta(kFormatKey, openvdb::Int32Metadata(kCacheFormat));
    meta.insertMeta("level", openvdb::Int32Metadata(header.level));
    meta.insertMeta("adaptive", openvdb::BoolMetadata(header.adaptive));
    meta.insertMeta("spacing", openvdb::DoubleMetadata(header.spacing));
    meta.insertMeta("rays", openvdb::Int32Metadata(header.rays));
    meta.insertMeta("seeds", openvdb::StringMetadata(header.seeds));
    meta.insertMeta("up_axis", openvdb::StringMetadata(header.upAxis));
    meta.insertMeta("unit", openvdb::DoubleMetadata(header.unit));
    meta.insertMeta("fingerprint", openvdb::StringMetadata(fingerprint));
    meta.insertMeta("version", openvdb::StringMetadata(header.version));
    meta.insertMeta("items", openvdb::Int64Metadata(static_cast<std::int64_t>(items.size())));
    return meta;
}

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
    const auto print = metaValue<std::string>(meta, "fingerprint", path);
    const auto parsed =
        std::from_chars(print.data(), print.data() + print.size(), header.fingerprint, 16);
    if (parsed.ec != std::errc() || parsed.ptr != print.data() + print.size())
        throwFileError(path, "fingerprint '" + print + "', wanted 16 hexadecimal digits");
    if (header.level < 0 || header.level > kMaxCacheLevel)
        throwFileError(path, "direction level " + std::to_string(header.level) + ", wanted 0 to 5");
    if (!(header.spacing > 0))
        throwFileError(path, "spacing " + std::to_string(header.spacing) + ", wanted above 0");
    return header;
}

void initializeOpenVdb() {
    static std::once_flag once;
    std::call_once(once, [] { openvdb::initialize(); });
}

template <class Grid>
typename Grid::Ptr takeGrid(openvdb::io::File& file, const char* name, const fs::path& path) {
    if (!file.hasGrid(name)) throwFileError(path, std::string("no grid '") + name + "'");
    const auto grid = openvdb::gridPtrCast<Grid>(file.readGrid(name));
    if (!grid) throwFileError(path, std::string("grid '") + name + "' is of another type");
    return grid;
}

}  // namespace

template <class Array>
const Array& attribute(const PointLeaf& leaf, const char* name, openvdb::Index stride,
                       const fs::path& path) {
    const std::size_t pos = leaf.attributeSet().find(name);
    if (pos == AttributeSet::INVALID_POS ||
        !leaf.constAttributeArray(pos).template isType<Array>() ||
        leaf.constAttributeArray(pos).stride() != stride)
        throwFileError(path, std::string("attribute '") + name + "' is missing or of another type");
    const auto& array = Array::cast(leaf.constAttributeArray(pos));
    array.loadData();
    return array;
}

template const ByteArray& attribute(const PointLeaf&, const char*, openvdb::Index, const fs::path&);
template const ShortArray& attribute(const PointLeaf&, const char*, openvdb::Index,
                                     const fs::path&);
template const IntArray& attribute(const PointLeaf&, const char*, openvdb::Index, const fs::path&);
template const VectorArray& attribute(const PointLeaf&, const char*, openvdb::Index,
                                      const fs::path&);

namespace {

std::uint8_t countAt(const ByteArray& array, std::size_t i) {
    return static_cast<std::uint8_t>(array.constData()[array.isUniform() ? 0 : i]);
}

/// Appends the items of one leaf, and their blocks.
void appendLeaf(const PointLeaf& leaf, const PointLeaf* blocks, std::size_t baseCells,
                const fs::path& path, CacheItems& items) {
    const auto& position = attribute<VectorArray>(leaf, "P", 1, path);
    const auto& normal = attribute<VectorArray>(leaf, "normal", 1, path);
    const auto& side = attribute<ByteArray>(leaf, "side", 1, path);
    const auto& count = attribute<ShortArray>(leaf, "block_count", 1, path);
    const auto& n = attribute<ByteArray>(leaf, "n", static_cast<openvdb::Index>(baseCells), path);
    const auto& d = attribute<ByteArray>(leaf, "d", static_cast<openvdb::Index>(baseCells), path);
    std::size_t block = 0;
    for (auto point = leaf.beginIndexAll(); point; ++point) {
        const openvdb::Index i = *point;
        const openvdb::Coord voxel = point.getCoord();
        const openvdb::Vec3f p = position.get(i), v = normal.get(i);
        items.voxel.emplace_back(voxel.x(), voxel.y(), voxel.z());
        items.side.push_back(static_cast<std::uint8_t>(side.get(i)));
        items.normal.emplace_back(v.x(), v.y(), v.z());
        items.position.emplace_back(p.x(), p.y(), p.z());
        for (std::size_t c = 0; c < baseCells; ++c) {
            items.n.push_back(countAt(n, i * baseCells + c));
            items.d.push_back(countAt(d, i * baseCells + c));
        }
        const auto more = static_cast<std::size_t>(std::max<std::int16_t>(0, count.get(i)));
        if (more > 0) {
            if (!blocks) throwFileError(path, "damaged: an item's blocks are missing");
            const auto& key = attribute<ShortArray>(*blocks, "key", 1, path);
            const auto& bn = attribute<ByteArray>(*blocks, "n", kBlockCells, path);
            const auto& bd = attribute<ByteArray>(*blocks, "d", kBlockCells, path);
            if (block + more > key.size())
                throwFileError(path, "damaged: an item's blocks lie outside the file's");
            for (const std::size_t end = block + more; block < end; ++block) {
                CountBlock b{
                    static_cast<std::uint16_t>(key.get(static_cast<openvdb::Index>(block))),
                    {},
                    {}};
                for (std::size_t c = 0; c < kBlockCells; ++c) {
                    b.n[c] = countAt(bn, block * kBlockCells + c);
                    b.d[c] = countAt(bd, block * kBlockCells + c);
                }
                items.blocks.push_back(b);
            }
        }
        items.firstBlock.push_back(static_cast<std::uint32_t>(items.blocks.size()));
    }
}

}  // namespace

CacheGrids readGrids(const fs::path& path) {
    initializeOpenVdb();
    std::error_code ignored;
    if (!fs::exists(path, ignored)) throwFileError(path, "no such file");
    if (fs::is_directory(path, ignored)) throwFileError(path, "a directory, wanted a cache file");
    if (fs::file_size(path, ignored) == 0) throwFileError(path, "empty, wanted a cache file");
    try {
        openvdb::io::File file(path.string());
        file.setCopyMaxBytes(0);
        file.open(false);
        const openvdb::MetaMap::Ptr meta = file.getMetadata();  // a fresh copy: keep it alive
        CacheGrids grids;
        grids.header = fromMetadata(*meta, path);
        grids.items = takeGrid<PointGrid>(file, kItemGrid, path);
        grids.blocks = takeGrid<PointGrid>(file, kBlockGrid, path);
        return grids;
    } catch (const openvdb::Exception& e) {
        throwFileError(path,
                       std::string("not a readable OpenVDB file, or cut short (") + e.what() + ")");
    } catch (const std::bad_alloc&) {
        throwFileError(path, "cut short or damaged (it asks for more memory than there is)");
    }
}

CacheItems readCache(const fs::path& path, CacheHeader& header) {
    const CacheGrids grids = readGrids(path);
    header = grids.header;
    const std::size_t baseCells = header.tiers().baseCells();
    CacheItems items;
    for (auto leaf = grids.items->tree().cbeginLeaf(); leaf; ++leaf)
        appendLeaf(*leaf, grids.blocks->tree().probeConstLeaf(leaf->origin()), baseCells, path,
                   items);
    return items;
}

std::uintmax_t writeCache(const fs::path& path, const CacheHeader& header,
                          const CacheItems& items) {
    initializeOpenVdb();
    requireWritable(path);
    std::error_code ignored;
    const PointGrids points = buildPointGrids(header, items);
    const VolumeGrids volumes = buildVolumeGrids(header, items);
    fs::path part = path;
    part += ".part";
    try {
        {
            openvdb::io::File file(part.string());
            file.setCompression(openvdb::io::COMPRESS_BLOSC | openvdb::io::COMPRESS_ACTIVE_MASK);
            file.write(openvdb::GridCPtrVec{points.items, points.blocks, volumes.openness,
                                            volumes.direction},
                       toMetadata(header, items));
        }
        // OpenVDB does not report a full disk; reading back does.
        readGrids(part);
        openvdb::io::File file(part.string());
        file.setCopyMaxBytes(0);
        file.open(false);
        takeGrid<openvdb::Vec3SGrid>(file, kOpenDirectionGrid, part);
        fs::rename(part, path);
    } catch (const std::exception& e) {
        const bool exists = fs::exists(part, ignored);
        fs::remove(part, ignored);
        throwFileError(path, exists ? "cannot be written completely (disk full?)"
                                    : std::string("cannot be written (") + e.what() + ")");
    }
    return fs::file_size(path);
}

}  // namespace shadowcache
