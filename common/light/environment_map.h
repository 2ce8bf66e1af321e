#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "common/image/image.h"
#include "common/math/vec.h"

namespace shadowcache {

class Progress;

/// Tables of a lat-long map that hold however it is turned. The map is cut into grains: texels with
/// centres in the same small cell of the direction mesh. All directions are in the map's own frame:
/// +Y is up, longitude 0 (image centre) is +Z, +pi/2 is +X. Immutable, thread-safe.
class EnvironmentMap {
public:
    /// @param map               width, height >= 1, finite and non-negative
    /// @param luminanceWeights  sum to 1
    /// @throws Error for an empty map or one of over 2^31 texels; Interrupted
    EnvironmentMap(const Image& map, const Rgb& luminanceWeights);

    const Rgb& luminanceWeights() const { return luminanceWeights_; }

    /// Texels of the map, replicated if it is small.
    std::size_t texelCount() const { return map_.size(); }
    /// Texel of the map, at y * width + x.
    struct Texel {
        Rgb radiance;
        float density;  ///< with which its grain's light is drawn [1/sr]

        Texel() noexcept {}  ///< leaves it unset, as a large map is not to be written twice
        Texel(const Rgb& radianceAlong, float densityOf)
            : radiance(radianceAlong), density(densityOf) {}
    };
    const Texel& texel(std::uint32_t index) const { return map_[index]; }
    /// Index of the texel along a unit direction.
    std::uint32_t texelAlong(const Vec3f& direction) const noexcept;
    /// Grain of a texel.
    std::uint32_t grainOf(std::uint32_t index) const { return grainOf_[index]; }
    /// Unit vector to the centre of a texel.
    Vec3d centerOf(std::uint32_t index) const noexcept;
    /// [sr]
    float solidAngleOf(std::uint32_t index) const noexcept;
    /// Unit vector to place (x, y) in [0, 1]^2 of a texel; uniform places are uniform in solid
    /// angle.
    Vec3d placeIn(std::uint32_t index, double x, double y) const noexcept;
    /// The same in single precision, for drawing.
    Vec3f placeIn(std::uint32_t index, float x, float y) const noexcept;

    /// A circle around a grain.
    struct Grain {
        Vec3f center;  ///< unit vector
        float radius;  ///< [rad]: no texel of the grain reaches farther
    };
    std::span<const Grain> grains() const { return grains_; }
    /// Integrals over a grain [radiance sr] for each colour, one after the other: of the radiance
    /// times the direction's products xx, yy, zz, xy, xz, yz, and of the radiance times x, y, z.
    struct alignas(16) Integrals {
        static constexpr int kSecond = 6, kFirst = 3, kOfColor = kSecond + kFirst;
        float value[28] = {};  ///< the last is 0
    };
    const Integrals& integralsOf(std::uint32_t grain) const { return integrals_[grain]; }

    /// First place in texelIndex() of a grain's texels, and the one behind its last.
    std::array<std::uint32_t, 2> texelsOf(std::uint32_t grain) const noexcept {
        return {firstTexel_[grain], firstTexel_[grain + 1]};
    }
    /// Index of the texel at a place in the order of the grains.
    std::uint32_t texelIndex(std::size_t place) const { return texels_[place]; }
    /// Index of the texel of a lit grain that owns one of the 2^32 steps of its light.
    std::uint32_t texelAtStep(std::uint32_t grain, std::uint32_t step) const noexcept;
    void prefetch(std::uint32_t grain) const { __builtin_prefetch(&firstTexel_[grain]); }
    void prefetchIntegrals(std::uint32_t grain) const {
        constexpr std::uintptr_t kLine = 64;
        const auto* bytes = reinterpret_cast<const char*>(&integrals_[grain]);
        for (std::uintptr_t i = 0; i < sizeof(Integrals); i += kLine) __builtin_prefetch(bytes + i);
        __builtin_prefetch(&grains_[grain]);
    }
    void prefetchTexel(std::uint32_t index) const { __builtin_prefetch(&map_[index]); }

    /// Upper bound of weights . radiance over the directions within `angle` [rad] of the unit
    /// vector `axis`.
    float greatest(const Vec3d& axis, double angle, const Rgb& weights) const noexcept;

private:
    void chooseSize(const Image& map);
    // Passes over all texels; each of them counts once in the progress.
    void copyTexels(const Image& map, Progress& progress);
    void nameGrains(Progress& progress);
    void sortTexels(Progress& progress);
    void integrate(Progress& progress);
    class GrainSum;

    std::size_t width_ = 0, height_ = 0;
    Rgb luminanceWeights_;
    std::vector<Texel> map_;
    std::vector<std::uint32_t> grainOf_;
    std::vector<std::uint32_t> texels_;      ///< indices, by grain
    std::vector<std::uint32_t> texelBegin_;  ///< steps in the light of the grain
    std::vector<std::uint32_t> firstTexel_;  ///< by grain, and the end
    std::vector<Grain> grains_;
    std::vector<Integrals> integrals_;
    std::vector<float> rowCos_, columnCos_, columnSin_;  ///< at texel borders
};

}  // namespace shadowcache
