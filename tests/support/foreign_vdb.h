#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace shadowcache::test {

// What OpenVDB alone, without this project's code, makes of a cache file and does to one.

/// A valid OpenVDB file with one level set and no word of a shadow cache.
void writeForeignVdb(const std::filesystem::path& path);

/// Rewrites a file with one integer of its metadata changed.
void setFileMetadata(const std::filesystem::path& path, const std::string& key, int value);

/// What a reader finds that knows the names in docs/format.md.
struct StockReading {
    std::size_t points = 0, blocks = 0;
    std::uint64_t sumN = 0, sumD = 0;  ///< over the items' base cells
    double voxelSize = 0;
    std::size_t openVoxels = 0;
    double minOpenness = 1, maxOpenness = 0;
    double longestDirection = 0;
};
StockReading readWithStockOpenVdb(const std::filesystem::path& path);

/// A grid of one value a voxel.
struct StockVolume {
    std::string name, valueType, gridClass, vectorType;
    double voxelSize = 0;
    std::map<std::array<int, 3>, std::array<float, 3>> values;  ///< of active voxels
};
std::vector<StockVolume> readVolumesWithStockOpenVdb(const std::filesystem::path& path);

/// The bytes of an OpenVDB file without what differs from one writing to the next: its own UUID.
std::string withoutUuids(std::string bytes);

}  // namespace shadowcache::test
