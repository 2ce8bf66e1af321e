#include "tests/support/test_scenes.h"

#include <algorithm>
#include <cmath>

#include "common/random/sequence.h"
#include "common/shot/view.h"
#include "render/table/estimator_table.h"
#include "tests/support/statistics.h"

namespace shadowcache::test {

namespace {

Vec3d latLong(double polar, double longitude) {
    return {std::sin(polar) * std::sin(longitude), std::cos(polar),
            std::sin(polar) * std::cos(longitude)};
}

Vec3d corner(const TriangleMesh& mesh, std::size_t triangle, int k) {
    return Vec3d(mesh.positions[static_cast<std::size_t>(mesh.triangles[triangle][k])]);
}

}  // namespace

void addTriangle(TriangleMesh& mesh, const Vec3f& a, const Vec3f& b, const Vec3f& c) {
    const int first = static_cast<int>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), {a, b, c});
    mesh.triangles.emplace_back(first, first + 1, first + 2);
}

void addQuad(TriangleMesh& mesh, const Vec3f& a, const Vec3f& b, const Vec3f& c, const Vec3f& d) {
    addTriangle(mesh, a, b, c);
    addTriangle(mesh, a, c, d);
}

void addFloor(TriangleMesh& mesh, float y, float x0, float x1, float z0, float z1) {
    addQuad(mesh, {x0, y, z0}, {x0, y, z1}, {x1, y, z1}, {x1, y, z0});
}

void addBox(TriangleMesh& mesh, const Vec3f& low, const Vec3f& high) {
    for (int axis = 0; axis < 3; ++axis)
        for (const Vec3f& at : {low, high}) {
            const int u = (axis + 1) % 3, v = (axis + 2) % 3;
            Vec3f c[4] = {low, low, high, high};
            for (Vec3f& p : c) p[axis] = at[axis];
            c[1][u] = high[u];
            c[1][v] = low[v];
            c[3][u] = low[u];
            c[3][v] = high[v];
            if (at == high)
                addQuad(mesh, c[0], c[1], c[2], c[3]);
            else
                addQuad(mesh, c[3], c[2], c[1], c[0]);
        }
}

void addSphere(TriangleMesh& mesh, const Vec3f& center, float radius, int rings) {
    const auto at = [&](int row, int column) {
        return center +
               Vec3f(latLong(kPi * row / rings, kPi * (column % (2 * rings)) / rings)) * radius;
    };
    for (int row = 0; row < rings; ++row)
        for (int column = 0; column < 2 * rings; ++column) {
            if (row + 1 < rings)
                addTriangle(mesh, at(row, column), at(row + 1, column), at(row + 1, column + 1));
            if (row > 0)
                addTriangle(mesh, at(row, column), at(row + 1, column + 1), at(row, column + 1));
        }
}

TriangleMesh floorMesh() {
    TriangleMesh mesh;
    addFloor(mesh, 0, -2, 2, -2, 2);
    return mesh;
}

TriangleMesh slabMesh() {
    TriangleMesh mesh = floorMesh();
    addBox(mesh, {0.5f, 1, -5}, {2, 1.5f, 5});
    return mesh;
}

ShadingPoint pointAlong(const Scene& scene, const Vec3f& from, const Vec3f& direction) {
    const Hit hit = scene.intersect(from, direction);
    if (!hit.found) throw Error("test: the ray meets nothing");
    const shadowcache::View view{direction, hit};
    const Vec3f side = view.geometricNormal();
    return {{scene.rayOrigin(hit.position, hit.triangle, side),
             scene.mesh().origin + Vec3d(hit.position), view.shadingNormal(), side},
            {}};
}

Image constantMap(const Rgb& radiance) {
    return {2, 1, {radiance, radiance}};
}

Image oneTexelMap(int width, int height, int x, int y, const Rgb& radiance) {
    Image map{width, height, {}};
    map.pixels.assign(static_cast<std::size_t>(width * height), Rgb(0, 0, 0));
    map.pixels[static_cast<std::size_t>(y * width + x)] = radiance;
    return map;
}

Image gradientMap(int width, int height, const Vec3d& slope) {
    Image map{width, height, {}};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const double solidAngle =
                2 * kPi / width * (std::cos(kPi * y / height) - std::cos(kPi * (y + 1) / height));
            const Vec3d mean = texelMoment(width, height, x, y) / solidAngle;
            map.pixels.emplace_back(static_cast<float>(std::max(0.0, 1 + slope.dot(mean))));
        }
    return map;
}

Image noiseMap(int width, int height, std::uint64_t seed) {
    Image map{width, height, {}};
    for (int i = 0; i < width * height; ++i) {
        const auto k = static_cast<std::uint64_t>(i);
        const auto number = [&](std::uint64_t c) {
            return static_cast<float>(std::pow(toUnit(hashWords(seed, k, c)), 4.0));
        };
        map.pixels.emplace_back(number(0), number(1), number(2));
    }
    map.pixels[static_cast<std::size_t>(width * (height / 3) + width / 5)] = Rgb(90, 70, 50);
    return map;
}

Environment environmentOf(const Image& map, double rotationDegrees) {
    return Environment(map, rotationDegrees, Rgb(0.2126f, 0.7152f, 0.0722f));
}

std::array<int, 2> texelAt(int width, int height, const Vec3d& direction) {
    const double turn = (kPi - std::atan2(direction.x, direction.z)) / (2 * kPi);
    const double polar = std::acos(std::clamp(direction.y, -1.0, 1.0)) / kPi;
    return {std::min(static_cast<int>((turn - std::floor(turn)) * width), width - 1),
            std::min(static_cast<int>(polar * height), height - 1)};
}

Vec3d texelMoment(int width, int height, int x, int y) {
    const double t0 = kPi * y / height, t1 = kPi * (y + 1) / height;
    const double p1 = kPi - 2 * kPi * x / width, p0 = p1 - 2 * kPi / width;
    const double sin2 = (t1 - t0) / 2 - (std::sin(2 * t1) - std::sin(2 * t0)) / 4;
    const double sinCos = (std::pow(std::sin(t1), 2) - std::pow(std::sin(t0), 2)) / 2;
    return {sin2 * (std::cos(p0) - std::cos(p1)), sinCos * (p1 - p0),
            sin2 * (std::sin(p1) - std::sin(p0))};
}

double polygonIrradiance(const Vec3d& p, const Vec3d& n, std::span<const Vec3d> polygon) {
    Vec3d sum(0, 0, 0);
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vec3d a = (polygon[i] - p).normalized();
        const Vec3d b = (polygon[(i + 1) % polygon.size()] - p).normalized();
        const Vec3d side = a.cross(b);
        const double sine = side.length();
        if (sine > 0) sum += side * (std::atan2(sine, a.dot(b)) / sine);
    }
    return std::abs(sum.dot(n)) / 2;
}

double hiddenByConvex(const TriangleMesh& mesh, std::size_t begin, std::size_t end,
                      const ShadingPoint& point) {
    const Vec3d p = point.place.position - mesh.origin;
    double sum = 0;
    for (std::size_t i = begin; i < end; ++i) {
        const std::array<Vec3d, 3> t{corner(mesh, i, 0), corner(mesh, i, 1), corner(mesh, i, 2)};
        if ((t[1] - t[0]).cross(t[2] - t[0]).dot(p - t[0]) > 0)
            sum += polygonIrradiance(p, Vec3d(point.place.normal), t);
    }
    return sum;
}

Rgb tracedIrradiance(const Scene& scene, const ShadingPoint& point, const Image& map,
                     int gridSize) {
    double sum[3] = {0, 0, 0};
    for (int y = 0; y < map.height; ++y)
        for (int x = 0; x < map.width; ++x) {
            const Rgb& radiance = map.pixels[static_cast<std::size_t>(y * map.width + x)];
            if (radiance == Rgb(0, 0, 0)) continue;
            const double seen =
                tracedTexelIrradiance(scene, point, map.width, map.height, x, y, gridSize);
            for (int c = 0; c < 3; ++c) sum[c] += seen * static_cast<double>(radiance[c]);
        }
    return {static_cast<float>(sum[0]), static_cast<float>(sum[1]), static_cast<float>(sum[2])};
}

double tracedTexelIrradiance(const Scene& scene, const ShadingPoint& point, int width, int height,
                             int x, int y, int gridSize) {
    const double cosTop = std::cos(kPi * y / height), cosBottom = std::cos(kPi * (y + 1) / height);
    double sum = 0;
    RayPacket packet{};
    for (int i = 0; i < gridSize; ++i)
        for (int j = 0; j < gridSize; ++j) {
            const double polar = std::acos(cosTop + (cosBottom - cosTop) * (i + 0.5) / gridSize);
            const Vec3d direction =
                latLong(polar, kPi - 2 * kPi * (x + (j + 0.5) / gridSize) / width);
            const double cosine = direction.dot(Vec3d(point.place.normal));
            if (cosine <= 0) continue;
            packet.set(0, point.place.rayOrigin, Vec3f(direction));
            if (scene.visibility(packet, 1)) sum += cosine;
        }
    return sum * 2 * kPi / width * (cosTop - cosBottom) / (gridSize * gridSize);
}

TestCache::TestCache(const CacheHeader& header, const CacheItems& items) {
    const auto path = folder_.path() / "cache.vdb";
    writeCache(path, header, items);
    cache_.emplace(path);
}

World::World(TriangleMesh set, const Image& map, const BakeOptions& options)
    : mesh(std::move(set)),
      scene(mesh),
      environment(environmentOf(map)),
      baked(bake(scene, options)),
      cache(baked),
      light(SetLight::of(scene, &cache.cache())) {}

double World::irradianceUnderSlab(const ShadingPoint& point) const {
    constexpr std::size_t kFloorTriangles = 2, kSlabTriangles = 12;
    ShadingPoint start = point;
    start.place.position = mesh.origin + Vec3d(point.place.rayOrigin);
    return kPi - hiddenByConvex(mesh, kFloorTriangles, kFloorTriangles + kSlabTriangles, start);
}

double Estimates::mean(int channel) const {
    const auto& values = color[static_cast<std::size_t>(channel)];
    double sum = 0;
    for (const double v : values) sum += v;
    return sum / static_cast<double>(values.size());
}

double Estimates::sampleVariance(int channel) const {
    const auto& values = color[static_cast<std::size_t>(channel)];
    const double average = mean(channel);
    double sum = 0;
    for (const double v : values) sum += (v - average) * (v - average);
    return sum / static_cast<double>(values.size() - 1);
}

Estimates runEstimator(const Estimator& estimator, const ShadingPoint& point, int samples,
                       int count, const EstimatorPlan* plan) {
    Estimates estimates;
    const auto workspace = estimator.makeWorkspace();
    ShadingPoint at = point;
    for (int i = 1; i <= count; ++i) {
        at.slot.seed =
            hashWords(static_cast<std::uint64_t>(i), static_cast<std::uint64_t>(samples));
        const Estimate e = estimator.estimate(at, samples, *workspace, plan);
        for (int c = 0; c < 3; ++c)
            estimates.color[static_cast<std::size_t>(c)].push_back(
                static_cast<double>(e.irradiance[c]));
        estimates.variance.push_back(static_cast<double>(e.variance));
        estimates.rays += e.rays;
    }
    return estimates;
}

double agreementPValue(const Estimates& estimates, const Rgb& truth) {
    // A sum of a few thousand floats, and of the moments behind it, is good to 2e-6.
    constexpr double kRounding = 2e-6;
    double least = 1;
    for (int c = 0; c < 3; ++c) {
        const auto wanted = static_cast<double>(truth[c]);
        const double nearest = std::clamp(estimates.mean(c), wanted - kRounding * std::abs(wanted),
                                          wanted + kRounding * std::abs(wanted));
        least = std::min(least, meanPValue(estimates.color[static_cast<std::size_t>(c)], nearest));
    }
    return std::min(1.0, 3 * least);
}

std::vector<NamedEstimator> everyEstimator(const EstimatorContext& context,
                                           const EstimatorOptions& options) {
    std::vector<NamedEstimator> all;
    for (const EstimatorEntry& entry : estimatorTable())
        if (context.cache || !entry.needsCache)
            all.push_back({entry.name, entry.make(context, options)});
    return all;
}

}  // namespace shadowcache::test
