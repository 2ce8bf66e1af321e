#include "common/cache/cache_schema.h"

namespace shadowcache {

namespace {

template <class Array>
AttributeSpec spec(const char* name, openvdb::Index stride) {
    return {name, Array::attributeType(), sizeof(typename Array::ValueType), stride};
}

}  // namespace

std::array<AttributeSpec, kItemAttributes> itemAttributes(const DirectionTiers& tiers) {
    return {spec<VectorArray>(kPositionName, 1),
            spec<VectorArray>("normal", 1),
            spec<ShortArray>("patch", 1),
            spec<ByteArray>("n", tiers.baseCells()),
            spec<ByteArray>("d", tiers.baseCells()),
            spec<IntArray>("first_block", 1),
            spec<ShortArray>("block_count", 1)};
}

std::array<AttributeSpec, kBlockAttributes> blockAttributes() {
    return {spec<ShortArray>("key", 1), spec<ByteArray>("n", kBlockCells),
            spec<ByteArray>("d", kBlockCells)};
}

}  // namespace shadowcache
