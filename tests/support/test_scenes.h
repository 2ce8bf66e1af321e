#pragma once

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bake/core/baker.h"
#include "common/image/image.h"
#include "render/estimators/estimator.h"
#include "render/library/set_light.h"
#include "render/table/estimator_table.h"
#include "tests/support/temporary_folder.h"

namespace shadowcache::test {

// Sets whose irradiance has a closed form, and what brings an estimator and a truth together.

void addTriangle(TriangleMesh& mesh, const Vec3f& a, const Vec3f& b, const Vec3f& c);
/// Two triangles of a planar quad, corners in order.
void addQuad(TriangleMesh& mesh, const Vec3f& a, const Vec3f& b, const Vec3f& c, const Vec3f& d);
/// Horizontal quad at height `y` over [x0, x1] x [z0, z1].
void addFloor(TriangleMesh& mesh, float y, float x0, float x1, float z0, float z1);
void addBox(TriangleMesh& mesh, const Vec3f& low, const Vec3f& high);
/// Convex polyhedron of 4 rings (rings - 1) triangles inscribed in a sphere.
void addSphere(TriangleMesh& mesh, const Vec3f& center, float radius, int rings);

TriangleMesh floorMesh();
/// That floor, and a slab over one side of it that hides a part of the sky: triangles [2, 14).
TriangleMesh slabMesh();

/// Where a ray from `from` (relative to the mesh's origin) along `direction` meets the set; its
/// seed is 0.
ShadingPoint pointAlong(const Scene& scene, const Vec3f& from, const Vec3f& direction);

Image constantMap(const Rgb& radiance);
Image oneTexelMap(int width, int height, int x, int y, const Rgb& radiance);
/// Luminance 1 + direction . slope, averaged over each texel; |slope| <= 1.
Image gradientMap(int width, int height, const Vec3d& slope);
/// Repeatable noise with a bright spot.
Image noiseMap(int width, int height, std::uint64_t seed);
Environment environmentOf(const Image& map, double rotationDegrees = 0);

/// Texel (x, y) of a map that holds a direction.
std::array<int, 2> texelAt(int width, int height, const Vec3d& direction);

/// Integral of the direction over texel (x, y) of a map, exact. [sr]
Vec3d texelMoment(int width, int height, int x, int y);

/// Irradiance at (p, n) from a polygon of radiance 1 wholly above the horizon, corners in either
/// order. [Lambert]
double polygonIrradiance(const Vec3d& p, const Vec3d& n, std::span<const Vec3d> polygon);

/// Irradiance at `point` that a convex body takes from a sky of radiance 1: its triangles [begin,
/// end) that face the point.
double hiddenByConvex(const TriangleMesh& mesh, std::size_t begin, std::size_t end,
                      const ShadingPoint& point);

/// Irradiance from texel (x, y) of a map by a ray per node of a fine grid.
double tracedTexelIrradiance(const Scene& scene, const ShadingPoint& point, int width, int height,
                             int x, int y, int gridSize);

/// The same from all of a map.
Rgb tracedIrradiance(const Scene& scene, const ShadingPoint& point, const Image& map, int gridSize);

/// An open cache with its file.
class TestCache {
public:
    TestCache(const CacheHeader& header, const CacheItems& items);
    explicit TestCache(const BakeResult& baked) : TestCache(baked.header, baked.items) {}

    const ShadowCache& cache() const { return *cache_; }

private:
    TemporaryFolder folder_;
    std::optional<ShadowCache> cache_;
};

/// A set under a map, baked.
struct World {
    TriangleMesh mesh;
    Scene scene;
    Environment environment;
    BakeResult baked;
    TestCache cache;
    std::unique_ptr<SetLight> light;  ///< null: nothing shines

    World(TriangleMesh set, const Image& map, const BakeOptions& options = {.spacing = 0.5});

    EstimatorContext context(Sequence sequence = Sequence::kSobol) const {
        return {scene,    environment, &cache.cache(),
                sequence, nullptr,     light ? &light->light() : nullptr};
    }
    /// The floor's middle.
    ShadingPoint below() const { return pointAlong(scene, {0, 0.25f, 0}, {0, -1, 0}); }
    /// What the slab of slabMesh() leaves of a sky of radiance 1 where shadow rays from `point`
    /// start.
    double irradianceUnderSlab(const ShadingPoint& point) const;
};

/// Estimates at one place with the seeds 1 .. count.
struct Estimates {
    std::array<std::vector<double>, 3> color;
    std::vector<double> variance;  ///< as the estimator judges itself
    std::uint64_t rays = 0;

    double mean(int channel) const;
    double sampleVariance(int channel) const;
};
Estimates runEstimator(const Estimator& estimator, const ShadingPoint& point, int samples,
                       int count, const EstimatorPlan* plan = nullptr);

/// p-value that the estimates have the mean `truth`, the least of the three colours times three; a
/// difference that float arithmetic explains does not count.
double agreementPValue(const Estimates& estimates, const Rgb& truth);

/// Every entry of estimatorTable(), made for the context.
struct NamedEstimator {
    std::string name;
    std::unique_ptr<Estimator> estimator;
};
std::vector<NamedEstimator> everyEstimator(const EstimatorContext& context,
                                           const EstimatorOptions& options = {});

}  // namespace shadowcache::test
