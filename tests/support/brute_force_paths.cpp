#include "tests/support/brute_force_paths.h"

#include <algorithm>
#include <vector>

#include "common/base/hash.h"
#include "common/base/parallel.h"
#include "common/mesh/placed_mesh.h"
#include "render/estimators/hemisphere.h"
#include "render/estimators/set_place.h"

namespace shadowcache::test {

namespace {

/// Numbers of one path.
class Numbers {
public:
    explicit Numbers(std::uint64_t seed) : seed_(seed) {}
    float next() { return static_cast<float>(toUnit(hashWords(seed_, ++drawn_))) * 0x1.fffffep-1f; }

private:
    std::uint64_t seed_, drawn_ = 0;
};

/// How a path goes on from a place.
struct Turn {
    Vec3f direction;
    Rgb weight;  ///< BRDF times the cosine over the density
};

/// By the cosine or by the lobe, each with probability 1/2 where there are both.
Turn turn(const Surface& surface, const Vec3f& normal, const Vec3f& toViewer, Numbers& numbers) {
    const float a = numbers.next(), u = numbers.next(), v = numbers.next();
    const Rgb diffuse = diffuseAlbedo(surface, normal.dot(toViewer)) * static_cast<float>(1 / kPi);
    const auto around = [&] { return aroundNormal(normal, std::sqrt(1 - u), v); };
    const auto cosine = [&](const Vec3f& w) { return std::max(0.0f, normal.dot(w)); };
    if (!surface.glossy) return {around(), diffuse * static_cast<float>(kPi)};
    const GlossyLobe lobe(surface, normal, toViewer);
    const Vec3f w = a < 0.5f ? around() : lobe.sample(u, v);
    const float density = 0.5f * (cosine(w) * static_cast<float>(1 / kPi) + lobe.density(w));
    if (!(density > 0)) return {w, Rgb(0, 0, 0)};
    return {w, (diffuse * cosine(w) + lobe.value(w)) * (1 / density)};
}

bool isUnseenBack(const Hit& hit, const Vec3f& direction) {
    return hit.normal.dot(direction) > 0 && !isDoubleSided(hit.scene->mesh(), hit.triangle);
}

}  // namespace

Rgb pathRadiance(const Scene& scene, const Environment& environment, const PlainLook& plain,
                 const Vec3f& origin, const Vec3f& direction, int bounces, std::uint64_t seed) {
    Numbers numbers(seed);
    Rgb sum(0, 0, 0), weight(1, 1, 1);
    View view{direction, scene.intersect(origin, direction)};
    if (!view.hit.found) return environment.radiance(direction) * view.hit.tint;
    for (int left = bounces;; --left) {
        const Surface surface = surfaceSeen(view.hit, plain);
        sum += weight * surface.emission;
        if (surface.unlit) return sum;
        const Vec3f normal = view.shadingNormal();
        const Turn next = turn(surface, normal, -view.direction, numbers);
        weight *= next.weight;
        if (weight == Rgb(0, 0, 0) || next.direction.dot(view.geometricNormal()) <= 0) return sum;
        RayPacket packet{};
        packet.set(0, rayStartOf(scene, view), next.direction);
        Hit hit;
        scene.meet(packet, 1, &hit);
        if (!hit.found) return sum + weight * environment.radiance(next.direction) * hit.tint;
        if (isUnseenBack(hit, next.direction)) return sum;
        // What the last surface is lit by emits, and reflects nothing any more.
        if (left == 0) return sum + weight * surfaceSeen(hit, plain).emission;
        if (left < 0) {
            const float chance = std::min(0.95f, std::max({weight.x, weight.y, weight.z}));
            if (numbers.next() >= chance) return sum;
            weight *= 1 / chance;
        }
        view = {next.direction, hit};
    }
}

Rgb meanPathRadiance(const Scene& scene, const Environment& environment, const PlainLook& plain,
                     const Vec3f& origin, const Vec3f& direction, int bounces, std::uint64_t seed,
                     int count) {
    const auto n = static_cast<std::size_t>(count);
    std::vector<Rgb> found(n);
    parallelFor(n, 4096, [&](const Chunk& chunk) {
        for (std::size_t i = chunk.begin; i < chunk.end; ++i)
            found[i] = pathRadiance(scene, environment, plain, origin, direction, bounces,
                                    hashWords(seed, i + 1));
    });
    Vec3d sum(0);
    for (const Rgb& radiance : found) sum += Vec3d(radiance);
    return Rgb(sum / static_cast<double>(n));
}

}  // namespace shadowcache::test
