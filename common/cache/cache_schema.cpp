#include "common/cache/cache_schema.h"

namespace shadowcache {

namespace {

template <class Array>
AttributeSpec spec(const char* name, openvdb::Index stride) {
    return {name, Array::attributeType(), sizeof(typename Array::ValueType), stride};
}

}  // namespace

std::array<AttributeSpec, kHits> lookupAttributes(const DirectionTiers& tiers) {
    return {spec<VectorArray>(kPositionName, 1),
            spec<VectorArray>("normal", 1),
            spec<ShortArray>("patch", 1),
            spec<ByteArray>("n", tiers.baseCells()),
            spec<ByteArray>("d", tiers.baseCells()),
            spec<IntArray>("first_block", 1),
            spec<ShortArray>("block_count", 1)};
}

std::vector<AttributeSpec> itemAttributes(const CacheHeader& header) {
    const auto lookups = lookupAttributes(header.tiers());
    std::vector<AttributeSpec> specs(lookups.begin(), lookups.end());
    if (header.hits > 0)
        specs.push_back(spec<ShortArray>("hits", static_cast<openvdb::Index>(header.hits)));
    if (!header.emitters.empty())
        specs.push_back(
            spec<ShortArray>("emitters", static_cast<openvdb::Index>(header.emitters.size())));
    return specs;
}

std::array<AttributeSpec, kBlockAttributes> blockAttributes() {
    return {spec<ShortArray>("key", 1), spec<ByteArray>("n", kBlockCells),
            spec<ByteArray>("d", kBlockCells)};
}

}  // namespace shadowcache
