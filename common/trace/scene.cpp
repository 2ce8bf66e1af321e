#include "common/trace/scene.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <tuple>
#include <vector>

#include "common/base/hash.h"
#include "common/base/tuned.h"
#include "common/mesh/looks.h"
#include "common/mesh/placed_mesh.h"
#include "common/trace/crossings.h"
#include "common/trace/embree_scene.h"

namespace shadowcache {

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Shadow rays in larger sets are traced as single rays: the packets of neighbouring rays that win
/// in the kitchen (83 k triangles, by a third) and tie in the atrium (155 k) lose around the dragon
/// (871 k).
SHADOWCACHE_TUNED(std::size_t, kManyTriangles, 300000);

/// Moving sets of more instances are one ball: every ball costs every shading point a little.
constexpr std::size_t kMostBalls = 16;

/// Number of a ray, of which surfaces that blend and panes make its chance to pass: the same ray,
/// asked again, passes again.
unsigned rayNumber(const Vec3f& origin, const Vec3f& direction) {
    const auto pair = [](float a, float b) {
        return std::uint64_t{std::bit_cast<std::uint32_t>(a)} << 32 |
               std::bit_cast<std::uint32_t>(b);
    };
    return static_cast<unsigned>(hashWords(pair(origin.x, origin.y), pair(origin.z, direction.x),
                                           pair(direction.y, direction.z)));
}

Vec3f originOf(const RayPacket& rays, int i) {
    return {rays.originX[i], rays.originY[i], rays.originZ[i]};
}

Vec3f directionOf(const RayPacket& rays, int i) {
    return {rays.directionX[i], rays.directionY[i], rays.directionZ[i]};
}

/// @param numbered  whether rays pass surfaces of the set by chance
void fillRays(const RayPacket& rays, bool numbered, RTCRay8& out) {
    for (int i = 0; numbered && i < RayPacket::kSize; ++i)
        out.id[i] = rayNumber(originOf(rays, i), directionOf(rays, i));
    constexpr std::size_t kBytes = sizeof(float) * RayPacket::kSize;
    std::memcpy(out.org_x, rays.originX, kBytes);
    std::memcpy(out.org_y, rays.originY, kBytes);
    std::memcpy(out.org_z, rays.originZ, kBytes);
    std::memcpy(out.dir_x, rays.directionX, kBytes);
    std::memcpy(out.dir_y, rays.directionY, kBytes);
    std::memcpy(out.dir_z, rays.directionZ, kBytes);
    for (int i = 0; i < RayPacket::kSize; ++i) {
        out.tnear[i] = 0.0f;
        out.time[i] = 0.0f;
        out.tfar[i] = kInfinity;
        out.mask[i] = ~0u;
        out.flags[i] = 0;
    }
}

struct Lanes {
    alignas(32) int valid[RayPacket::kSize];
    explicit Lanes(int count) {
        for (int i = 0; i < RayPacket::kSize; ++i) valid[i] = i < count ? -1 : 0;
    }
};

RTCIntersectContextFlags packetFlags(const TriangleMesh& mesh) {
    return mesh.instances.empty() ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT
                                  : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
}

/// Shadow rays of a packet stay together among large triangles and part among small ones.
RTCIntersectContextFlags shadowFlags(bool many) {
    return many ? RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT : RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
}

/// How rays pass what was hit.
Passage passageOf(const Hit& hit, const Material& material, const Vec3f& direction) {
    const TriangleMesh& mesh = hit.scene->mesh();
    return passageAt(mesh, material, placedTriangle(mesh, hit.triangle).triangle, hit.u, hit.v,
                     hit.normal.dot(direction));
}

/// Of what was hit; null where it has none.
const Material* materialOf(const Hit& hit) {
    const TriangleMesh& mesh = hit.scene->mesh();
    return materialOf(mesh, placedTriangle(mesh, hit.triangle).triangle);
}

RTCRay rayOf(const Vec3f& origin, const Vec3f& direction, float reach, bool numbered) {
    RTCRay ray{};
    ray.org_x = origin.x;
    ray.org_y = origin.y;
    ray.org_z = origin.z;
    ray.dir_x = direction.x;
    ray.dir_y = direction.y;
    ray.dir_z = direction.z;
    ray.tfar = reach;
    ray.mask = ~0u;
    if (numbered) ray.id = rayNumber(origin, direction);
    return ray;
}

/// What Embree knows of a hit.
Hit byEmbree(const RTCHit& hit, float distance) {
    Hit known;
    known.u = hit.u;
    known.v = hit.v;
    known.distance = distance;
    return known;
}

/// How far a ray goes before what it hit, which is no pane on the way to itself, up to rounding.
float beforeHit(const Hit& hit) {
    return hit.found ? hit.distance * (1 - 0x1p-18f) : kInfinity;
}

Ball ballAround(const Box3d& box) {
    // Rounded up.
    return {Vec3f(box.center()), static_cast<float>(box.size().length() / 2 * 1.00001)};
}

}  // namespace

Scene::Scene(const TriangleMesh& mesh)
    : mesh_(mesh),
      byChance_(std::ranges::any_of(mesh.materials, &Material::passesByChance)),
      panes_(std::ranges::any_of(mesh.materials, &Material::isPane)),
      tints_(
          std::ranges::any_of(mesh.materials, [&](const Material& m) { return mayTint(mesh, m); })),
      // Embree 3.13 sometimes never returns from streams of coherent rays that meet instances.
      many_(placedCount(mesh) >= kManyTriangles || !mesh.instances.empty()),
      embree_(std::make_unique<EmbreeScene>(mesh)) {}

Scene::~Scene() = default;

void Scene::setMoving(const Scene* moving) {
    moving_ = moving;
    movingBalls_.clear();
    for (; moving; moving = moving->moving_) {
        const TriangleMesh& mesh = moving->mesh();
        if (mesh.instances.empty() || mesh.instances.size() > kMostBalls) {
            movingBalls_.push_back(ballAround(placedBounds(mesh)));
            continue;
        }
        for (const MeshInstance& instance : mesh.instances)
            if (instance.toWorld.invertible())  // else it is hidden
                movingBalls_.push_back(ballAround(instanceBounds(mesh, instance)));
    }
}

Vec3f Scene::normal(std::uint32_t triangle) const noexcept {
    return placedNormal(mesh_, triangle);
}

/// Of a triangle of the world that Embree found. Its own numbers differ in their last bits from one
/// instruction set to the next; these do not. [Möller & Trumbore 1997]
///
/// @param byEmbree  u, v and distance, for a ray in the triangle's plane
Hit Scene::hitAt(const Vec3f& origin, const Vec3f& direction, std::uint32_t triangle,
                 const Hit& byEmbree) const noexcept {
    const std::array<Vec3d, 3> corners = placedCorners(mesh_, triangle);
    const auto& [a, b, c] = corners;
    const Vec3d d(direction), ab = b - a, ac = c - a, toOrigin = Vec3d(origin) - a;
    const Vec3d across = d.cross(ac), along = toOrigin.cross(ab);
    const double determinant = ab.dot(across);
    Hit hit = byEmbree;
    hit.found = true;
    hit.scene = this;
    hit.triangle = triangle;
    if (determinant != 0) {
        // On an edge rounding may put the place beside the triangle.
        const double u = std::clamp(toOrigin.dot(across) / determinant, 0.0, 1.0);
        hit.u = static_cast<float>(u);
        hit.v = static_cast<float>(std::clamp(d.dot(along) / determinant, 0.0, 1 - u));
        hit.distance = static_cast<float>(ac.dot(along) / determinant);
    }
    hit.position = Vec3f(a + ab * static_cast<double>(hit.u) + ac * static_cast<double>(hit.v));
    hit.normal = placedNormal(mesh_, triangle, corners);
    // What a pane sends to a ray that it stops counts as much more as it stops fewer.
    if (const Material* material = panes_ ? materialOf(hit) : nullptr;
        material && material->isPane())
        hit.weight = passageOf(hit, *material, direction).weight;
    return hit;
}

Hit Scene::intersect(const Vec3f& origin, const Vec3f& direction) const noexcept {
    Hit hit = nearest(origin, direction);
    if (tints()) hit.tint = tint(origin, direction, beforeHit(hit));
    return hit;
}

void Scene::intersect(const RayPacket& rays, int count, Hit* hits) const noexcept {
    nearest(rays, count, true, hits);
    if (tints()) addTints(rays, count, hits);
}

void Scene::meet(const RayPacket& rays, int count, Hit* hits) const noexcept {
    nearest(rays, count, false, hits);
    if (tints()) addTints(rays, count, hits);
}

void Scene::meetStill(const RayPacket& rays, int count, Hit* hits) const noexcept {
    std::fill_n(hits, count, Hit{});
    addNearest(rays, count, false, hits);
}

void Scene::addTints(const RayPacket& rays, int count, Hit* hits) const noexcept {
    for (int i = 0; i < count; ++i)
        hits[i].tint = tint(originOf(rays, i), directionOf(rays, i), beforeHit(hits[i]));
}

Rgb Scene::tint(const Vec3f& origin, const Vec3f& direction, float reach) const noexcept {
    Rgb tint(1, 1, 1);
    if (tints_) {
        QueryContext context;
        context.tint = &tint;
        RTCRay query = rayOf(origin, direction, reach, byChance_);
        rtcOccluded1(embree_->root(), &context.base, &query);
    }
    return moving_ ? tint * moving_->tint(origin, direction, reach) : tint;
}

Hit Scene::nearest(const Vec3f& origin, const Vec3f& direction) const noexcept {
    QueryContext context;
    context.fromCamera = true;
    RTCRayHit query{};
    query.ray = rayOf(origin, direction, kInfinity, byChance_);
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(embree_->root(), &context.base, &query);

    Hit hit;
    if (moving_) hit = moving_->nearest(origin, direction);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return hit;
    if (hit.found && hit.distance < query.ray.tfar) return hit;
    return hitAt(origin, direction, embree_->placedNumber(query.hit),
                 byEmbree(query.hit, query.ray.tfar));
}

void Scene::look(const CameraPacket& rays, int count, float leastOfPanes, Hit* hits) const {
    std::vector<Crossing> crossings;
    nearest(rays, count, hits, crossings);
    std::ranges::stable_sort(crossings, {}, [](const Crossing& c) {
        return std::tuple(c.ray, c.hit.distance, c.hit.triangle);
    });
    auto next = crossings.begin();
    for (int i = 0; i < count; ++i) {
        Hit& hit = hits[i];
        const auto first = next;
        while (next != crossings.end() && next->ray == i) ++next;
        const float end = hit.found ? hit.distance : rays.reach[i];
        const auto last =
            std::find_if(first, next, [&](const Crossing& c) { return c.hit.distance > end; });
        hit = chosenOf({first, last}, hit, {rays.chance[i], leastOfPanes});
    }
}

void Scene::nearest(const RayPacket& rays, int count, bool fromCamera, Hit* hits) const noexcept {
    if (moving_)
        moving_->nearest(rays, count, fromCamera, hits);
    else
        std::fill_n(hits, count, Hit{});
    addNearest(rays, count, fromCamera, hits);
}

void Scene::addNearest(const RayPacket& rays, int count, bool fromCamera,
                       Hit* hits) const noexcept {
    QueryContext context;
    context.fromCamera = fromCamera;
    // Of light's rays not even neighbours stay together.
    context.base.flags = fromCamera ? packetFlags(mesh_) : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    alignas(32) RTCRayHit8 query;
    fillRays(rays, byChance_, query.ray);
    takeNearer(rays, count, context, query, hits);
}

void Scene::nearest(const CameraPacket& rays, int count, Hit* hits,
                    std::vector<Crossing>& crossings) const {
    std::vector<ChanceHit> met;
    QueryContext context;
    context.fromCamera = true;
    context.crossings = &met;
    context.base.flags = packetFlags(mesh_);
    alignas(32) RTCRayHit8 query;
    fillRays(rays, false, query.ray);
    for (unsigned i = 0; i < RayPacket::kSize; ++i) query.ray.id[i] = i;
    std::copy_n(rays.reach, count, query.ray.tfar);
    if (moving_)
        moving_->nearest(rays, count, hits, crossings);
    else
        std::fill_n(hits, count, Hit{});
    takeNearer(rays, count, context, query, hits);
    for (const ChanceHit& c : met) {
        const auto ray = static_cast<int>(c.ray);
        const Vec3f direction = directionOf(rays, ray);
        const Hit hit = hitAt(originOf(rays, ray), direction, embree_->placedNumber(c.hit),
                              byEmbree(c.hit, c.distance));
        const Material& material = *materialOf(hit);
        crossings.push_back({ray, hit, passageOf(hit, material, direction), material.isPane()});
    }
}

void Scene::takeNearer(const RayPacket& rays, int count, QueryContext& context, RTCRayHit8& query,
                       Hit* hits) const noexcept {
    for (int i = 0; i < RayPacket::kSize; ++i)
        query.hit.geomID[i] = query.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    const Lanes lanes(count);
    rtcIntersect8(lanes.valid, embree_->root(), &context.base, &query);
    for (int i = 0; i < count; ++i) {
        if (query.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
        const float distance = query.ray.tfar[i];
        if (hits[i].found && hits[i].distance < distance) continue;
        const RTCHit hit = rtcGetHitFromHitN(reinterpret_cast<RTCHitN*>(&query.hit),
                                             RayPacket::kSize, static_cast<unsigned>(i));
        hits[i] = hitAt(originOf(rays, i), directionOf(rays, i), embree_->placedNumber(hit),
                        byEmbree(hit, distance));
    }
}

bool Scene::isFree(const Vec3f& origin, const Vec3f& way) const noexcept {
    QueryContext context;
    RTCRay query = rayOf(origin, way, 1, byChance_);
    rtcOccluded1(embree_->root(), &context.base, &query);
    return query.tfar >= 0.0f && (!moving_ || moving_->isFree(origin, way));
}

std::uint32_t Scene::visibility(const RayPacket& rays, int count) const noexcept {
    QueryContext context;
    context.base.flags = shadowFlags(many_);
    alignas(32) RTCRay8 query;
    fillRays(rays, byChance_, query);
    const Lanes lanes(count);
    rtcOccluded8(lanes.valid, embree_->root(), &context.base, &query);
    std::uint32_t bits = 0;
    for (int i = 0; i < count; ++i)
        bits |= static_cast<std::uint32_t>(query.tfar[i] >= 0.0f) << i;  // -inf on a hit
    return moving_ && bits != 0 ? bits & moving_->visibility(rays, count) : bits;
}

void Scene::trace(RayStream& rays, std::size_t count) const noexcept {
    alignas(64) static constexpr float kNearest[RayStream::kSize] = {};
    RTCRayNp query{};
    query.org_x = rays.origin[0];
    query.org_y = rays.origin[1];
    query.org_z = rays.origin[2];
    query.dir_x = rays.direction[0];
    query.dir_y = rays.direction[1];
    query.dir_z = rays.direction[2];
    query.tnear = const_cast<float*>(kNearest);  // only read
    query.tfar = rays.reach;
    unsigned numbers[RayStream::kSize];
    for (std::size_t i = 0; byChance_ && i < count; ++i)
        numbers[i] = rayNumber({rays.origin[0][i], rays.origin[1][i], rays.origin[2][i]},
                               {rays.direction[0][i], rays.direction[1][i], rays.direction[2][i]});
    if (byChance_) query.id = numbers;
    QueryContext context;
    context.base.flags = shadowFlags(many_);
    rtcOccludedNp(embree_->root(), &context.base, &query, static_cast<unsigned>(count));
    if (moving_) moving_->trace(rays, count);
}

void Scene::distances(const RayPacket& rays, int count, float* out) const noexcept {
    QueryContext context;
    alignas(32) RTCRayHit8 query;
    fillRays(rays, byChance_, query.ray);
    for (unsigned& id : query.hit.geomID) id = RTC_INVALID_GEOMETRY_ID;
    const Lanes lanes(count);
    rtcIntersect8(lanes.valid, embree_->root(), &context.base, &query);
    std::copy_n(query.ray.tfar, count, out);  // still infinite where nothing was hit
    if (!moving_) return;
    float near[RayPacket::kSize];
    moving_->distances(rays, count, near);
    for (int i = 0; i < count; ++i) out[i] = std::min(out[i], near[i]);
}

}  // namespace shadowcache
