#include "tests/support/foreign_vdb.h"

#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>
#include <openvdb/points/PointCount.h>
#include <openvdb/points/PointDataGrid.h>
#include <openvdb/tools/LevelSetSphere.h>

#include <algorithm>
#include <limits>

namespace shadowcache::test {

namespace {

using openvdb::points::PointDataGrid;

/// Sum of all values of a strided attribute of 8-bit counts.
std::uint64_t sumOf(const PointDataGrid& grid, const char* name) {
    std::uint64_t sum = 0;
    for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf) {
        const openvdb::points::AttributeHandle<std::int8_t> handle(leaf->constAttributeArray(name));
        for (openvdb::Index i = 0; i < handle.size(); ++i)
            for (openvdb::Index c = 0; c < handle.stride(); ++c)
                sum += static_cast<std::uint8_t>(handle.get(i, c));
    }
    return sum;
}

}  // namespace

void writeForeignVdb(const std::filesystem::path& path) {
    openvdb::initialize();
    const auto sphere = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(
        1.0f, openvdb::Vec3f(0, 0, 0), 0.3f);
    openvdb::io::File(path.string()).write(openvdb::GridCPtrVec{sphere});
}

void setFileMetadata(const std::filesystem::path& path, const std::string& key, int value) {
    openvdb::initialize();
    openvdb::GridPtrVecPtr grids;
    openvdb::MetaMap::Ptr metadata;
    {
        openvdb::io::File file(path.string());
        file.open(false);
        grids = file.getGrids();
        metadata = file.getMetadata();
        file.close();
    }
    metadata->insertMeta(key, openvdb::Int32Metadata(value));
    openvdb::io::File(path.string()).write(*grids, *metadata);
}

StockReading readWithStockOpenVdb(const std::filesystem::path& path) {
    openvdb::initialize();
    openvdb::io::File file(path.string());
    file.open();
    StockReading reading;
    const auto items = openvdb::gridPtrCast<PointDataGrid>(file.readGrid("shadowcache_items"));
    const auto blocks = openvdb::gridPtrCast<PointDataGrid>(file.readGrid("shadowcache_blocks"));
    reading.points = openvdb::points::pointCount(items->tree());
    reading.blocks = openvdb::points::pointCount(blocks->tree());
    reading.voxelSize = items->voxelSize()[0];
    reading.sumN = sumOf(*items, "n");
    reading.sumD = sumOf(*items, "d");
    const auto openness = openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid("openness"));
    for (auto value = openness->cbeginValueOn(); value; ++value) {
        ++reading.openVoxels;
        reading.minOpenness = std::min(reading.minOpenness, static_cast<double>(*value));
        reading.maxOpenness = std::max(reading.maxOpenness, static_cast<double>(*value));
    }
    const auto direction =
        openvdb::gridPtrCast<openvdb::Vec3SGrid>(file.readGrid("open_direction"));
    for (auto value = direction->cbeginValueOn(); value; ++value)
        reading.longestDirection =
            std::max(reading.longestDirection, static_cast<double>(value->length()));
    return reading;
}

std::vector<StockVolume> readVolumesWithStockOpenVdb(const std::filesystem::path& path) {
    openvdb::initialize();
    openvdb::io::File file(path.string());
    file.open();
    std::vector<StockVolume> volumes;
    const openvdb::GridPtrVecPtr grids = file.getGrids();
    for (const openvdb::GridBase::Ptr& grid : *grids) {
        StockVolume volume{grid->getName(),
                           grid->valueType(),
                           openvdb::GridBase::gridClassToString(grid->getGridClass()),
                           openvdb::GridBase::vecTypeToString(grid->getVectorType()),
                           grid->voxelSize()[0],
                           {}};
        const auto fill = [&](const auto& typed, auto valueOf) {
            for (auto value = typed->cbeginValueOn(); value; ++value) {
                const openvdb::Coord c = value.getCoord();
                volume.values[{c.x(), c.y(), c.z()}] = valueOf(*value);
            }
        };
        if (const auto scalar = openvdb::gridPtrCast<openvdb::FloatGrid>(grid))
            fill(scalar, [](float v) { return std::array{v, v, v}; });
        if (const auto vector = openvdb::gridPtrCast<openvdb::Vec3SGrid>(grid))
            fill(vector, [](const openvdb::Vec3s& v) { return std::array{v[0], v[1], v[2]}; });
        volumes.push_back(std::move(volume));
    }
    return volumes;
}

std::string withoutUuids(std::string bytes) {
    // Magic number, versions, the flag for offsets, then 36 characters.
    constexpr std::size_t kBegin = 8 + 4 + 4 + 4 + 1, kLength = 36;
    if (bytes.size() > kBegin + kLength) bytes.erase(kBegin, kLength);
    return bytes;
}

}  // namespace shadowcache::test
