#include "bake/core/region_bytes.h"

#include "bake/core/byte_stream.h"

namespace shadowcache {

std::uint64_t bytesOf(const CacheItems& items) {
    const auto of = [](const auto& values) { return values.size() * sizeof(values[0]); };
    return of(items.voxel) + of(items.patch) + of(items.normal) + of(items.position) + of(items.n) +
           of(items.d) + of(items.firstBlock) + of(items.blocks) + of(items.hits);
}

std::string toBytes(const Baked& baked) {
    ByteWriter out;
    const CacheItems& items = baked.items;
    out.put(baked.rays);
    out.put(items.voxel);
    out.put(items.patch);
    out.put(items.normal);
    out.put(items.position);
    out.put(items.n);
    out.put(items.d);
    out.put(items.firstBlock);
    out.put(items.blocks);
    out.put(items.hits);
    return out.take();
}

Baked bakedFromBytes(std::string_view bytes) {
    ByteReader in(bytes);
    Baked baked;
    CacheItems& items = baked.items;
    baked.rays = in.get<std::uint64_t>();
    items.voxel = in.getVector<Vec3i>();
    items.patch = in.getVector<std::int16_t>();
    items.normal = in.getVector<Vec3f>();
    items.position = in.getVector<Vec3f>();
    items.n = in.getVector<std::uint8_t>();
    items.d = in.getVector<std::uint8_t>();
    items.firstBlock = in.getVector<std::uint32_t>();
    items.blocks = in.getVector<CountBlock>();
    items.hits = in.getVector<std::uint16_t>();
    return baked;
}

std::string toBytes(const std::vector<std::vector<Pilot>>& pilots) {
    ByteWriter out;
    out.put(std::uint64_t{pilots.size()});
    for (const auto& voxel : pilots) {
        out.put(std::uint64_t{voxel.size()});
        for (const Pilot& pilot : voxel) {
            out.put(pilot.normal);
            out.put(pilot.position);
            out.put(pilot.visible);
            out.put(pilot.occluded);
            out.put(pilot.counts);
            out.put(pilot.rays);
        }
    }
    return out.take();
}

std::vector<std::vector<Pilot>> pilotsFromBytes(std::string_view bytes) {
    ByteReader in(bytes);
    std::vector<std::vector<Pilot>> pilots;
    for (auto voxels = in.get<std::uint64_t>(); voxels > 0; --voxels) {
        auto& voxel = pilots.emplace_back();
        for (auto count = in.get<std::uint64_t>(); count > 0; --count) {
            Pilot& pilot = voxel.emplace_back();
            pilot.normal = in.get<Vec3f>();
            pilot.position = in.get<Vec3f>();
            pilot.visible = in.get<CellSet>();
            pilot.occluded = in.get<CellSet>();
            pilot.counts = in.getVector<Count>();
            pilot.rays = in.get<std::uint64_t>();
        }
    }
    return pilots;
}

}  // namespace shadowcache
