#include "bake/inspect/bounced_light.h"

#include <map>
#include <tuple>

#include "common/base/error.h"
#include "common/predict/bounce_solve.h"

namespace shadowcache {

std::vector<Rgb> bouncedIrradiance(const std::filesystem::path& path, const CacheItems& items,
                                   const Environment& environment) {
    const ShadowCache cache(path);
    const ItemTable table(cache);
    const auto transport = readTransport(cache, table);
    if (!transport)
        throwFileError(path,
                       "holds no transport, of which bounces are made: bake without "
                       "--no-transport");
    const std::vector<ItemLook> looks(table.size());
    const BounceSolve solve(cache, table, *transport, environment, looks, -1);
    // Numbers of an open cache are not those of its arrays.
    const auto key = [](const Vec3i& voxel, std::int16_t patch) {
        return std::tuple(voxel.x, voxel.y, voxel.z, patch);
    };
    std::map<decltype(key(Vec3i(), 0)), std::uint32_t> numbers;
    for (std::uint32_t i = 0; i < table.size(); ++i)
        numbers[key(table.item(i).voxel, table.item(i).patch)] = i;
    std::vector<Rgb> irradiance;
    irradiance.reserve(items.size());
    for (std::size_t i = 0; i < items.size(); ++i)
        irradiance.push_back(solve.irradiance(numbers.at(key(items.voxel[i], items.patch[i])), -1));
    return irradiance;
}

}  // namespace shadowcache
