#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "common/mesh/mesh.h"
#include "common/trace/hit.h"

struct RTCRayHit8;

namespace shadowcache {

class EmbreeScene;
class Scene;
struct Crossing;
struct QueryContext;

// Whether a ray passes a hole or a pane is decided by passes() of embree_scene.cpp, with
// passageAt() of common/mesh/looks.h.

/// Eight rays, as arrays; origins relative to the mesh's origin, directions
/// unit.
struct alignas(32) RayPacket {
    static constexpr int kSize = 8;
    float originX[kSize], originY[kSize], originZ[kSize];
    float directionX[kSize], directionY[kSize], directionZ[kSize];

    void set(int i, const Vec3f& origin, const Vec3f& direction) {
        originX[i] = origin.x;
        originY[i] = origin.y;
        originZ[i] = origin.z;
        directionX[i] = direction.x;
        directionY[i] = direction.y;
        directionZ[i] = direction.z;
    }
};

/// Eight rays from a camera.
struct CameraPacket : RayPacket {
    float chance[kSize];  ///< in [0, 1): decides which of the surfaces that it may pass a ray shows
    float reach[kSize];   ///< nothing is met beyond

    void set(int i, const Vec3f& origin, const Vec3f& direction, float chanceOfRay,
             double farthest) {
        RayPacket::set(i, origin, direction);
        chance[i] = chanceOfRay;
        reach[i] = static_cast<float>(farthest);
    }
};

/// The way from one place off a surface to another, as Scene::rayOrigin() finds both, for a ray
/// that ends there: it ends farther off, by what is rounded off of the way. rayOrigin() alone knows
/// what is rounded off where a ray begins, which is next to nothing on a floor at a height of 0.
///
/// @param side  unit, off the surface at `to`
inline Vec3f wayBetween(const Vec3f& from, const Vec3f& to, const Vec3f& side) {
    const auto extent = [](const Vec3f& v) {
        return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
    };
    // Sixteen unit roundoffs, as of the origin of a ray.
    constexpr float kRounded = 0x1p-20f;
    return to - from + side * (kRounded * std::max(extent(from), extent(to)));
}

/// Shadow rays toward the sky in bulk, as arrays; origins relative to the mesh's origin, directions
/// of any length.
struct RayStream {
    static constexpr std::size_t kSize = 256;
    alignas(64) float origin[3][kSize];
    alignas(64) float direction[3][kSize];
    alignas(64) float reach[kSize];  ///< in lengths of the direction; negative once it is occluded
};

struct Ball {
    Vec3f center;
    float radius;
};

/// The set's triangles in an acceleration structure. A surface that blends stops a ray with the
/// probability of its opacity there, a pane with that of the light that it does not transmit; the
/// same ray meets the same in every query but look(). Queries are thread-safe.
class Scene {
public:
    /// Keeps a reference to `mesh`, which must outlive the scene.
    ///
    /// @throws Error when memory runs out
    explicit Scene(const TriangleMesh& mesh);
    ~Scene();
    Scene(const Scene&) = delete;
    Scene& operator=(const Scene&) = delete;

    const TriangleMesh& mesh() const { return mesh_; }

    /// Puts what moves into the scene, in place of what was there before; null: nothing. Its mesh
    /// has the same origin. Queries see it. Not thread-safe.
    void setMoving(const Scene* moving);

    /// Balls around what moves, relative to the mesh's origin.
    const std::vector<Ball>& movingBalls() const { return movingBalls_; }

    /// Nearest hit of a ray from a camera, which looks through holes and through the backs of
    /// surfaces that are not double-sided.
    Hit intersect(const Vec3f& origin, const Vec3f& direction) const noexcept;

    /// The same of `count` rays (<= 8), which cost less together where they are near each other.
    ///
    /// @param hits  as many
    void intersect(const RayPacket& rays, int count, Hit* hits) const noexcept;

    /// The same of rays whose given chances, not their own, decide about all that they may pass: so
    /// rays whose chances are stratified show all of it in even shares. What they show is right on
    /// the mean if each counts by its Hit::share.
    ///
    /// @param leastOfPanes  least part of the rays that cross panes which show what these mirror
    ///                      and scatter, in [0, 1), or eight times as many as stop there: it is
    ///                      little light, but noisy
    void look(const CameraPacket& rays, int count, float leastOfPanes, Hit* hits) const;

    /// The same of rays that light travels along: they pass through holes, and backs stop them as
    /// they stop shadow rays.
    void meet(const RayPacket& rays, int count, Hit* hits) const noexcept;

    /// The same of the set alone, without what moves and without tints.
    void meetStill(const RayPacket& rays, int count, Hit* hits) const noexcept;

    /// Whether some pane is coloured.
    bool tints() const { return tints_ || (moving_ && moving_->tints()); }

    /// Factor by which panes tint what a ray carries that nothing stops before its end: passageAt()
    /// of all that it passes (looks.h, embree_scene.cpp).
    ///
    /// @param reach  in lengths of the direction
    Rgb tint(const Vec3f& origin, const Vec3f& direction,
             float reach = std::numeric_limits<float>::infinity()) const noexcept;

    /// Whether nothing lies between a place and the one that is `way` from it.
    bool isFree(const Vec3f& origin, const Vec3f& way) const noexcept;

    /// Bit i: ray i (< count <= 8) reaches the sky.
    std::uint32_t visibility(const RayPacket& rays, int count) const noexcept;

    /// Finds out which of the first `count` rays of a stream reach the sky. Fastest when neighbours
    /// in the stream are near each other in place and direction.
    void trace(RayStream& rays, std::size_t count) const noexcept;

    /// Distances to the first hit of `count` rays, infinite where there is none.
    void distances(const RayPacket& rays, int count, float* out) const noexcept;

    /// Unit geometric normal of a triangle, by its winding in the file.
    Vec3f normal(std::uint32_t triangle) const noexcept;

    /// Origin for rays that leave `position` on `triangle` on the side of the unit vector `side`:
    /// moved off the surface by an amount scaled to the corners' own ulp, so that no ray meets the
    /// triangle it starts from. [Wächter & Binder 2019]
    Vec3f rayOrigin(const Vec3f& position, std::uint32_t triangle,
                    const Vec3f& side) const noexcept;

private:
    /// Of a camera's ray, without tints; so are the next.
    Hit nearest(const Vec3f& origin, const Vec3f& direction) const noexcept;
    /// @param fromCamera  backs of surfaces that are not double-sided are not seen
    void nearest(const RayPacket& rays, int count, bool fromCamera, Hit* hits) const noexcept;
    /// Puts what the set alone has nearer in place of what lies behind it.
    void addNearest(const RayPacket& rays, int count, bool fromCamera, Hit* hits) const noexcept;
    /// Of camera's rays that pass all that they may pass.
    void nearest(const CameraPacket& rays, int count, Hit* hits,
                 std::vector<Crossing>& crossings) const;
    /// Traces a packet, and puts what it meets in place of what lies behind it.
    void takeNearer(const RayPacket& rays, int count, QueryContext& context, RTCRayHit8& query,
                    Hit* hits) const noexcept;
    void addTints(const RayPacket& rays, int count, Hit* hits) const noexcept;
    Hit hitAt(const Vec3f& origin, const Vec3f& direction, std::uint32_t triangle,
              const Hit& byEmbree) const noexcept;

    const TriangleMesh& mesh_;
    bool byChance_;  ///< rays pass some surface by chance
    bool panes_;     ///< some surface is a pane
    bool tints_;     ///< and one of them coloured
    bool many_;
    std::unique_ptr<EmbreeScene> embree_;
    const Scene* moving_ = nullptr;
    std::vector<Ball> movingBalls_;
};

}  // namespace shadowcache
