#pragma once

#include <cstdint>

namespace shadowcache {

/// Largest spacing that is accepted.
inline constexpr double kMostSpacing = 1e12;

/// How fine a cache is: each takes about eight times the rays of the one before.
enum class BakeQuality { draft, good, fine };

/// Options of a bake. Their names, ranges and help are rows of bake/library/bake_rows.cpp; for a
/// shot bake/shot/shot_spacing.cpp chooses spacing and level where they are not given.
struct BakeOptions {
    double spacing = 0;  ///< side of a voxel, world units; 0: chosen by the set and the quality
    BakeQuality quality = BakeQuality::good;  ///< where no spacing is given
    int level = 5;                            ///< finest direction level, 0 .. 5
    int rays = 16;                            ///< rays per region where rays disagree, 1 .. 255
    bool adaptive = true;    ///< finer regions only where they explain the visibility
    bool transport = true;   ///< also keep which items the rays of each item met
    bool lamps = true;       ///< also count how much of the set's emitters the items see
    std::uint64_t seed = 1;  ///< of all random numbers
    int shard = 0;           ///< of `shards`: bakes only the voxels that fall to it
    int shards = 1;          ///< parts that the set's voxels are divided into, at least 1
};

/// @throws Error naming the option, the value and the range allowed
void validate(const BakeOptions& options);

}  // namespace shadowcache
