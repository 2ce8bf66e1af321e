#include <algorithm>
#include <span>

#include "common/base/atomic_file.h"
#include "common/base/error.h"
#include "common/base/parallel.h"
#include "common/cache/cache_grids.h"
#include "common/cache/cache_header_file.h"
#include "common/cache/cache_items.h"
#include "common/cache/cache_schema.h"
#include "common/cache/vdb_archive.h"
#include "common/cache/vdb_volumes.h"

namespace shadowcache {

namespace {

namespace fs = std::filesystem;
using openvdb::points::AttributeSet;
using openvdb::points::PointDataTree;

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

/// A points leaf with `count` points, the position and the attributes `specs`. `descriptors` holds
/// the chain of descriptors, shared by all leaves.
void initializeLeaf(PointLeaf& leaf, std::size_t count, std::span<const AttributeSpec> specs,
                    std::vector<AttributeSet::Descriptor::Ptr>& descriptors) {
    leaf.initializeAttributes(descriptors[0], static_cast<openvdb::Index>(count));
    for (std::size_t k = 0; k < specs.size(); ++k)
        leaf.appendAttribute(*descriptors[k], descriptors[k + 1], k + 1, specs[k].stride, true);
}

std::vector<AttributeSet::Descriptor::Ptr> describe(std::span<const AttributeSpec> specs) {
    std::vector<AttributeSet::Descriptor::Ptr> chain{
        AttributeSet::Descriptor::create(VectorArray::attributeType())};
    for (const AttributeSpec& spec : specs)
        chain.push_back(chain.back()->duplicateAppend(spec.name, spec.type));
    return chain;
}

/// The array of a leaf's attribute, by its place in the file's order.
template <class Array>
Array& expanded(PointLeaf& leaf, std::size_t place) {
    auto& array = Array::cast(leaf.attributeArray(place));
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
                  const CacheHeader& header) {
    const std::size_t baseCells = header.tiers().baseCells();
    setOffsets(leaf, range.end - range.begin,
               [&](std::size_t i) { return toCoord(items.voxel[range.begin + i]); });
    auto& position = expanded<VectorArray>(leaf, kPosition);
    auto& normal = expanded<VectorArray>(leaf, kNormal);
    auto& patch = expanded<ShortArray>(leaf, kPatch);
    auto& n = expanded<ByteArray>(leaf, kItemN);
    auto& d = expanded<ByteArray>(leaf, kItemD);
    auto& firstBlock = expanded<IntArray>(leaf, kFirstBlock);
    auto& blockCount = expanded<ShortArray>(leaf, kBlockCount);
    const std::uint32_t leafBlocks = items.firstBlock[range.begin];
    for (std::size_t i = range.begin; i < range.end; ++i) {
        const auto k = static_cast<openvdb::Index>(i - range.begin);
        const Vec3f& p = items.position[i];
        const Vec3f& v = items.normal[i];
        position.setUnsafe(k, openvdb::Vec3f(p.x, p.y, p.z));
        normal.setUnsafe(k, openvdb::Vec3f(v.x, v.y, v.z));
        patch.setUnsafe(k, items.patch[i]);
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
    const auto fill = [&](std::size_t place, std::size_t stride,
                          const std::vector<std::uint16_t>& values) {
        if (stride == 0) return;
        auto& array = expanded<ShortArray>(leaf, place);
        for (std::size_t h = range.begin * stride; h < range.end * stride; ++h)
            array.setUnsafe(static_cast<openvdb::Index>(h - range.begin * stride),
                            static_cast<std::int16_t>(values[h]));
    };
    fill(kHits, static_cast<std::size_t>(header.hits), items.hits);
    fill(emitterPlace(header), header.emitters.size(), items.emitters);
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
    constexpr std::size_t kBehindPosition = 1;
    auto& key = expanded<ShortArray>(leaf, kBehindPosition + kKey);
    auto& n = expanded<ByteArray>(leaf, kBehindPosition + kBlockN);
    auto& d = expanded<ByteArray>(leaf, kBehindPosition + kBlockD);
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
    grid->setTransform(makeTransform(spacing));
    return grid;
}

}  // namespace

CacheGrids makeGrids(const CacheHeader& header, const CacheItems& items) {
    initializeOpenVdb();
    const std::vector<AttributeSpec> itemAttributeSpecs = itemAttributes(header);
    const auto itemSpecs = std::span(itemAttributeSpecs).subspan(kPosition + 1);
    const auto blockSpecs = blockAttributes();
    auto itemDescriptors = describe(itemSpecs);
    auto blockDescriptors = describe(blockSpecs);
    CacheGrids grids{header, makePointGrid(kItemGrid, header.spacing),
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
            fillItemLeaf(*itemLeaves[i], leaves[i], items, header);
            if (blockLeaves[i]) fillBlockLeaf(*blockLeaves[i], leaves[i], items);
        }
    });
    return grids;
}

std::uintmax_t writeCache(const fs::path& path, const CacheHeader& header,
                          const CacheItems& items) {
    requireWritable(path);
    const CacheGrids points = makeGrids(header, items);
    const VoxelRuns runs = findVoxels(items);
    const auto volume = [&](const VolumeGrid& grid) {
        return makeVdbGrid(header, runs.voxels, grid);
    };
    // The points stand last, where whoever reads them meets the end of a file cut short.
    writeVdb(path,
             {volume(skyVisibilityGrid(header, items, runs)),
              volume(bentNormalGrid(header, items, runs)), points.blocks, points.items},
             toMetadata(header, items.size()));
    return fs::file_size(path);
}

}  // namespace shadowcache
