#include "bake/library/bake_set.h"

namespace shadowcache {

void recordFiles(const MeshOptions& options, CacheHeader& header) {
    header.upAxis = std::string{options.zUp ? 'z' : 'y'};
    header.unit = options.scale;
}

BakeResult bakeSet(const LoadedSet& set, const BakeOptions& options) {
    BakeResult result = bake(set.scene, options);
    recordFiles(set.options, result.header);
    return result;
}

}  // namespace shadowcache
