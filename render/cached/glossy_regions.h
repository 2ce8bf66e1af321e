#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/surface/surface.h"
#include "render/cached/regions.h"

namespace shadowcache {

/// Cells of Environment::kLevel that hold the texels of a map. Immutable, thread-safe.
class TexelCells {
public:
    explicit TexelCells(const Environment& environment);

    /// @param texel  Environment::Texel::index
    std::uint32_t cell(std::uint32_t texel) const { return cells_[texel]; }

private:
    std::vector<std::uint16_t> cells_;
};

/// The light of a cluster's regions, drawn from for a lobe: regions in proportion to the light
/// that the lobe reflects and the root of the probability that it is visible, and a share by their
/// light alone; directions in them by their luminance. It is a `Light` of queueGloss().
class GlossyRegions {
public:
    explicit GlossyRegions(const Environment& environment);

    /// Regions of a cluster, for the lobe of the point in its middle.
    ///
    /// @return whether there is any light
    bool build(const Regions& regions, const GlossyLobe& lobe, const TexelCells& cells);

    EnvironmentSample sample(double u, float jitterX, float jitterY) const;
    float density(const EnvironmentSample& s) const;

private:
    struct Entry {
        int level;
        std::uint32_t cell;
        double guided, plain;  ///< weights
    };

    const Environment& environment_;
    const TexelCells* cells_ = nullptr;
    std::vector<Entry> entries_;
    std::vector<double> begin_;  ///< sum of the probabilities before each entry, and 1
    /// Probability of a cell over its light, by level and cell; 0: no region.
    std::array<std::vector<float>, Environment::kLevel + 1> perLight_;
    std::array<bool, Environment::kLevel + 1> used_{};
};

}  // namespace shadowcache
