#include "bake/core/region_bytes.h"

#include "bake/core/byte_stream.h"

namespace shadowcache {

std::uint64_t bytesOf(const CacheItems& items) {
    const auto of = [](const auto& values) { return values.size() * sizeof(values[0]); };
    return of(items.voxel) + of(items.patch) + of(items.normal) + of(items.position) + of(items.n) +
           of(items.d) + of(items.firstBlock) + of(items.blocks) + of(items.hits) +
           of(items.emitters);
}

std::string toBytes(const Baked& baked) {
    ByteWriter out;
    const CacheItems& items = baked.items;
    out.put(baked.rays);
    out.put(baked.emitterRays);
    out.put(items.voxel);
    out.put(items.patch);
    out.put(items.normal);
    out.put(items.position);
    out.put(items.n);
    out.put(items.d);
    out.put(items.firstBlock);
    out.put(items.blocks);
    out.put(items.hits);
    out.put(items.emitters);
    return out.take();
}

Baked bakedFromBytes(std::string_view bytes) {
    ByteReader in(bytes);
    Baked baked;
    CacheItems& items = baked.items;
    baked.rays = in.get<std::uint64_t>();
    baked.emitterRays = in.get<std::uint64_t>();
    items.voxel = in.getVector<Vec3i>();
    items.patch = in.getVector<std::int16_t>();
    items.normal = in.getVector<Vec3f>();
    items.position = in.getVector<Vec3f>();
    items.n = in.getVector<std::uint8_t>();
    items.d = in.getVector<std::uint8_t>();
    items.firstBlock = in.getVector<std::uint32_t>();
    items.blocks = in.getVector<CountBlock>();
    items.hits = in.getVector<std::uint16_t>();
    items.emitters = in.getVector<std::uint16_t>();
    return baked;
}

std::string toBytes(const std::vector<std::vector<Probe>>& probes) {
    ByteWriter out;
    out.put(std::uint64_t{probes.size()});
    for (const auto& voxel : probes) {
        out.put(std::uint64_t{voxel.size()});
        for (const Probe& probe : voxel) {
            out.put(probe.normal);
            out.put(probe.position);
            out.put(probe.visible);
            out.put(probe.occluded);
            out.put(probe.counts);
            out.put(probe.rays);
        }
    }
    return out.take();
}

std::vector<std::vector<Probe>> probesFromBytes(std::string_view bytes) {
    ByteReader in(bytes);
    std::vector<std::vector<Probe>> probes;
    for (auto voxels = in.get<std::uint64_t>(); voxels > 0; --voxels) {
        auto& voxel = probes.emplace_back();
        for (auto count = in.get<std::uint64_t>(); count > 0; --count) {
            Probe& probe = voxel.emplace_back();
            probe.normal = in.get<Vec3f>();
            probe.position = in.get<Vec3f>();
            probe.visible = in.get<CellSet>();
            probe.occluded = in.get<CellSet>();
            probe.counts = in.getVector<Count>();
            probe.rays = in.get<std::uint64_t>();
        }
    }
    return probes;
}

}  // namespace shadowcache
