#include "common/cache/leaf_view.h"

#include <algorithm>
#include <array>

#include "common/base/error.h"
#include "common/cache/emitter_code.h"
#include "common/cache/hit_code.h"
#include "common/cache/patch_code.h"

namespace shadowcache {

CountRows constantRows(std::uint8_t value) {
    static const auto rows = [] {
        std::array<std::array<std::uint8_t, cellCount(1)>, 256> table{};
        for (std::size_t v = 0; v < table.size(); ++v) table[v].fill(static_cast<std::uint8_t>(v));
        return table;
    }();
    return {rows[value].data(), 0};
}

void requireSound(const LeafView& leaf, const DirectionTiers& tiers,
                  const std::filesystem::path& path) {
    std::uint32_t end = 0;
    for (std::size_t v = 0; v < kLeafVoxels; ++v) {
        if (leaf.voxelEnd[v] < end || leaf.voxelEnd[v] > leaf.items)
            throwFileError(path, "damaged: a voxel's items lie outside the file's");
        end = leaf.voxelEnd[v];
    }
    if (end != leaf.items) throwFileError(path, "damaged: an item lies in no voxel");
    std::int64_t next = 0;
    for (std::uint32_t i = 0; i < leaf.items; ++i) {
        const std::int64_t past = next + leaf.blockCount[i];
        if (leaf.firstBlock[i] != next || past < next || past > leaf.blocks)
            throwFileError(path, "damaged: an item's blocks lie outside the file's");
        if (!PatchCode::isValid(leaf.patch[i]))
            throwFileError(path, "damaged: an item's patch does not exist");
        for (std::int64_t b = next + 1; b < past; ++b)
            if (leaf.blockKeys[b] <= leaf.blockKeys[b - 1])
                throwFileError(path, "damaged: an item's blocks are not in order");
        next = past;
    }
    if (next != leaf.blocks)
        throwFileError(path, "damaged: an item's blocks lie outside the file's");
    const int keys = tiers.blockKey(1, cellCount(tiers.baseLevel() + 2));
    for (std::uint32_t b = 0; b < leaf.blocks; ++b)
        if (leaf.blockKeys[b] < 0 || leaf.blockKeys[b] >= keys)
            throwFileError(path, "damaged: a block refines a region that does not exist");
    requireSoundHits(leaf, path);
}

void requireSoundHits(const LeafView& leaf, const std::filesystem::path& path) {
    const std::uint16_t* last = leaf.emitters + std::size_t{leaf.items} * leaf.emittersPerItem;
    if (leaf.emitters && !std::all_of(leaf.emitters, last, EmitterCode::isValid))
        throwFileError(path, "damaged: more rays reach an emitter than were counted");
    if (!leaf.hits) return;
    const std::uint16_t* end = leaf.hits + std::size_t{leaf.items} * leaf.hitsPerItem;
    if (!std::all_of(leaf.hits, end, HitCode::isValid))
        throwFileError(path, "damaged: a ray's hit does not exist");
}

}  // namespace shadowcache
