#include "common/scene.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "common/error.h"
#include "common/parallel.h"

namespace shadowcache {

struct Scene::Impl {
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;

    ~Impl() {
        if (scene) rtcReleaseScene(scene);
        if (device) rtcReleaseDevice(device);
    }
};

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Sets of more are traced as single rays: the packets of neighbouring rays that win in the kitchen
/// (83 k triangles, by a third) and tie in the atrium (155 k) lose around the dragon (871 k).
constexpr std::size_t kManyTriangles = 300000;

void throwOnError(RTCDevice device) {
    if (rtcGetDeviceError(device) != RTC_ERROR_NONE)
        throw Error("ray tracing: building the acceleration structure failed (out of memory?)");
}

void fillRays(const RayPacket& rays, RTCRay8& out) {
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

float maxAbs(const Vec3f& v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

}  // namespace

Scene::Scene(const TriangleMesh& mesh) : mesh_(mesh), impl_(std::make_unique<Impl>()) {
    const std::string config = "threads=" + std::to_string(threadCount());
    impl_->device = rtcNewDevice(config.c_str());
    if (!impl_->device) throw Error("ray tracing: no device (Embree found no usable processor)");
    impl_->scene = rtcNewScene(impl_->device);
    RTCGeometry geometry = rtcNewGeometry(impl_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    // Embree reads 16 bytes a corner; a copy of its own carries the padding.
    void* corners = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                            sizeof(Vec3f), mesh.positions.size());
    void* indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                            sizeof(Vec3i), mesh.triangles.size());
    if (!corners || !indices) throwOnError(impl_->device);
    std::uninitialized_copy(mesh.positions.begin(), mesh.positions.end(),
                            static_cast<Vec3f*>(corners));
    std::uninitialized_copy(mesh.triangles.begin(), mesh.triangles.end(),
                            static_cast<Vec3i*>(indices));
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(impl_->scene, geometry);
    rtcReleaseGeometry(geometry);
    // Robust: no ray slips between neighbouring triangles.
    rtcSetSceneFlags(impl_->scene, RTC_SCENE_FLAG_ROBUST);
    rtcCommitScene(impl_->scene);
    throwOnError(impl_->device);
}

Scene::~Scene() = default;

Vec3f Scene::normal(std::uint32_t triangle) const noexcept {
    const Vec3i& t = mesh_.triangles[triangle];
    const Vec3d a(mesh_.positions[static_cast<std::size_t>(t.x)]);
    const Vec3d b(mesh_.positions[static_cast<std::size_t>(t.y)]);
    const Vec3d c(mesh_.positions[static_cast<std::size_t>(t.z)]);
    return Vec3f((b - a).cross(c - a).normalized());
}

Hit Scene::intersect(const Vec3f& origin, const Vec3f& direction) const noexcept {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit query{};
    query.ray.org_x = origin.x;
    query.ray.org_y = origin.y;
    query.ray.org_z = origin.z;
    query.ray.dir_x = direction.x;
    query.ray.dir_y = direction.y;
    query.ray.dir_z = direction.z;
    query.ray.tfar = kInfinity;
    query.ray.mask = ~0u;
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(impl_->scene, &context, &query);

    Hit hit;
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return hit;
    hit.found = true;
    hit.triangle = query.hit.primID;
    hit.u = query.hit.u;
    hit.v = query.hit.v;
    hit.distance = query.ray.tfar;
    const Vec3i& t = mesh_.triangles[hit.triangle];
    const Vec3f& a = mesh_.positions[static_cast<std::size_t>(t.x)];
    const Vec3f& b = mesh_.positions[static_cast<std::size_t>(t.y)];
    const Vec3f& c = mesh_.positions[static_cast<std::size_t>(t.z)];
    hit.position = a + (b - a) * hit.u + (c - a) * hit.v;
    hit.normal = normal(hit.triangle);
    return hit;
}

std::uint32_t Scene::visibility(const RayPacket& rays, int count) const noexcept {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    alignas(32) RTCRay8 query;
    fillRays(rays, query);
    const Lanes lanes(count);
    rtcOccluded8(lanes.valid, impl_->scene, &context, &query);
    std::uint32_t bits = 0;
    for (int i = 0; i < count; ++i)
        bits |= static_cast<std::uint32_t>(query.tfar[i] >= 0.0f) << i;  // -inf on a hit
    return bits;
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
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    // Rays of a packet stay together among large triangles and part among small ones.
    context.flags = mesh_.triangles.size() < kManyTriangles ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT
                                                            : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    rtcOccludedNp(impl_->scene, &context, &query, static_cast<unsigned>(count));
}

void Scene::distances(const RayPacket& rays, int count, float* out) const noexcept {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    alignas(32) RTCRayHit8 query;
    fillRays(rays, query.ray);
    for (unsigned& id : query.hit.geomID) id = RTC_INVALID_GEOMETRY_ID;
    const Lanes lanes(count);
    rtcIntersect8(lanes.valid, impl_->scene, &context, &query);
    std::copy_n(query.ray.tfar, count, out);  // still infinite where nothing was hit
}

Vec3f Scene::rayOrigin(const Vec3f& position, std::uint32_t triangle,
                       const Vec3f& side) const noexcept {
    const Vec3i& t = mesh_.triangles[triangle];
    const float scale = std::max({maxAbs(mesh_.positions[static_cast<std::size_t>(t.x)]),
                                  maxAbs(mesh_.positions[static_cast<std::size_t>(t.y)]),
                                  maxAbs(mesh_.positions[static_cast<std::size_t>(t.z)])});
    // A point interpolated from three corners is off its plane by a few ulp (2^-23) of the largest.
    return position + side * (scale * 0x1p-19f);
}

}  // namespace shadowcache
