#include "common/cache/grid_leaves.h"

#include "common/base/error.h"

namespace shadowcache {

namespace {

namespace fs = std::filesystem;
using openvdb::points::AttributeArray;
using openvdb::points::AttributeSet;

/// The attribute's array in memory, type and stride checked.
AttributeArray& arrayOf(PointLeaf& leaf, const AttributeSpec& spec, const fs::path& path) {
    const std::size_t place = leaf.attributeSet().find(spec.name);
    if (place == AttributeSet::INVALID_POS || leaf.attributeArray(place).type() != spec.type ||
        leaf.attributeArray(place).stride() != spec.stride)
        throwFileError(path,
                       std::string("attribute '") + spec.name + "' is missing or of another type");
    AttributeArray& array = leaf.attributeArray(place);
    array.loadData();
    return array;
}

/// Values of an attribute as a plain array.
template <class Value, class Array>
const Value* values(PointLeaf& leaf, const AttributeSpec& spec, const fs::path& path) {
    auto& array = Array::cast(arrayOf(leaf, spec, path));
    array.expand();
    static_assert(sizeof(Value) == sizeof(typename Array::ValueType));
    return reinterpret_cast<const Value*>(array.constData());
}

CountRows countRows(PointLeaf& leaf, const AttributeSpec& spec, const fs::path& path) {
    const auto& array = ByteArray::cast(arrayOf(leaf, spec, path));
    if (array.isUniform()) return constantRows(static_cast<std::uint8_t>(array.get(0)));
    return {reinterpret_cast<const std::uint8_t*>(array.constData()), spec.stride};
}

std::uint32_t pointCount(const PointLeaf& leaf, const fs::path& path) {
    const auto& attributes = leaf.attributeSet();
    const openvdb::Index count = attributes.get(0)->size();
    for (std::size_t a = 1; a < attributes.size(); ++a)
        if (attributes.get(a)->size() != count)
            throwFileError(path, "damaged: attributes of one leaf differ in their number");
    return count;
}

}  // namespace

LeafView viewOf(PointLeaf& items, PointLeaf* blocks, const CacheHeader& header,
                const fs::path& path) {
    const std::vector<AttributeSpec> specs = itemAttributes(header);
    LeafView view;
    static_assert(sizeof *view.voxelEnd == sizeof *items.buffer().data());
    view.voxelEnd = reinterpret_cast<const std::uint32_t*>(items.buffer().data());
    view.items = pointCount(items, path);
    view.n = countRows(items, specs[kItemN], path);
    view.d = countRows(items, specs[kItemD], path);
    view.normal = values<Vec3f, VectorArray>(items, specs[kNormal], path);
    view.position = values<Vec3f, VectorArray>(items, specs[kPosition], path);
    view.patch = values<std::int16_t, ShortArray>(items, specs[kPatch], path);
    view.firstBlock = values<std::int32_t, IntArray>(items, specs[kFirstBlock], path);
    view.blockCount = values<std::int16_t, ShortArray>(items, specs[kBlockCount], path);
    if (header.hits > 0) {
        view.hits = values<std::uint16_t, ShortArray>(items, specs[kHits], path);
        view.hitsPerItem = specs[kHits].stride;
    }
    if (!header.emitters.empty()) {
        const AttributeSpec& spec = specs[emitterPlace(header)];
        view.emitters = values<std::uint16_t, ShortArray>(items, spec, path);
        view.emittersPerItem = spec.stride;
    }
    if (blocks) {
        const auto blockSpecs = blockAttributes();
        view.blocks = pointCount(*blocks, path);
        view.blockKeys = values<std::int16_t, ShortArray>(*blocks, blockSpecs[kKey], path);
        view.blockN = countRows(*blocks, blockSpecs[kBlockN], path);
        view.blockD = countRows(*blocks, blockSpecs[kBlockD], path);
    }
    requireSound(view, header.tiers(), path);
    return view;
}

}  // namespace shadowcache
