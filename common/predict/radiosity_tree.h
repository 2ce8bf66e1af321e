#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/predict/bounce_solve.h"

namespace shadowcache {

/// What surfaces reflect to a place, as a cache predicts it: its items as a tree of balls, as
/// lights are in [Conty Estevez & Kulla 2018]. Immutable, thread-safe.
class RadiosityTree {
public:
    /// @param solve    outlives the tree
    /// @param looks    by item
    /// @param bounces  of the light that is reflected; below 0: all
    /// @param origin   of the set, world space: places are relative to it
    RadiosityTree(const BounceSolve& solve, std::span<const ItemLook> looks, int bounces,
                  const Rgb& luminanceWeights, const Vec3d& origin);

    const BounceSolve& solve() const { return solve_; }

    /// Bytes of memory that it takes.
    std::size_t memoryBytes() const {
        return radiance_.capacity() * sizeof(float) + nodes_.capacity() * sizeof(Node);
    }

    /// Luminance that an item sends to all sides.
    float radianceOf(std::uint32_t item) const { return radiance_[item]; }

    /// A ball that holds the middles of some items.
    struct Ball {
        Vec3f centre{0};
        float radius = 0;  ///< at least that of one item
    };
    /// Balls that send the most to a place, at most `most`, smaller where more comes from. What is
    /// in the way does not count.
    ///
    /// @param normal  unit
    std::vector<Ball> brightestFor(const Vec3f& position, const Vec3f& normal,
                                   std::size_t most) const;

private:
    struct Node {
        Ball ball;
        float power = 0;         ///< radiance times area
        Vec3f facing{0};         ///< mean normal, by power
        std::uint32_t left = 0;  ///< the first of its two children, which are neighbours; 0: none
    };
    struct Lit;

    Node summed(std::span<const Lit> items) const;
    void build(std::size_t node, std::span<Lit> items);
    static float irradianceOf(const Node& node, const Vec3f& position, const Vec3f& normal);

    const BounceSolve& solve_;
    const float itemRadius_, itemArea_;
    std::vector<float> radiance_;  ///< by item
    std::vector<Node> nodes_;      ///< the first is the root; none where nothing is lit
};

}  // namespace shadowcache
