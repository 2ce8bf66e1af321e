#include "common/cache/vdb_volumes.h"

#include "common/cache/vdb_archive.h"

namespace shadowcache {

namespace {

template <class Grid>
typename Grid::Ptr makeGrid(const CacheHeader& header, const VolumeGrid& grid) {
    auto out = Grid::create();
    out->setName(grid.name);
    out->setTransform(makeTransform(header.spacing));
    out->setSaveFloatAsHalf(true);
    return out;
}

}  // namespace

openvdb::GridBase::Ptr makeVdbGrid(const CacheHeader& header, const std::vector<Vec3i>& voxels,
                                   const VolumeGrid& grid) {
    const auto fill = [&](auto out, auto valueOf) -> openvdb::GridBase::Ptr {
        auto accessor = out->getAccessor();
        for (std::size_t v = 0; v < voxels.size(); ++v)
            accessor.setValue(toCoord(voxels[v]), valueOf(grid.values[v]));
        return out;
    };
    if (grid.kind == VolumeKind::fog) {
        auto out = makeGrid<openvdb::FloatGrid>(header, grid);
        out->setGridClass(openvdb::GRID_FOG_VOLUME);
        return fill(out, [](const Vec3f& value) { return value.x; });
    }
    auto out = makeGrid<openvdb::Vec3SGrid>(header, grid);
    out->setVectorType(grid.kind == VolumeKind::direction ? openvdb::VEC_CONTRAVARIANT_RELATIVE
                                                          : openvdb::VEC_INVARIANT);
    return fill(out, [](const Vec3f& value) { return openvdb::Vec3s(value.x, value.y, value.z); });
}

void writeVolumes(const std::filesystem::path& path, const CacheHeader& header,
                  const std::vector<Vec3i>& voxels, const std::vector<VolumeGrid>& grids) {
    initializeOpenVdb();
    openvdb::GridCPtrVec out;
    for (const VolumeGrid& grid : grids) out.push_back(makeVdbGrid(header, voxels, grid));
    writeVdb(path, out, {});
}

}  // namespace shadowcache
