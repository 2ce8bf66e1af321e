#include "common/trace/embree_scene.h"

#include <array>
#include <atomic>
#include <cmath>
#include <memory>

#include "common/base/error.h"
#include "common/base/hash.h"
#include "common/base/interrupt.h"
#include "common/mesh/looks.h"
#include "common/mesh/placed_mesh.h"

namespace shadowcache {

EmbreeScene::EmbreeScene(const TriangleMesh& mesh) : mesh_(mesh), parts_(mesh.parts) {
    if (parts_.empty())
        parts_.push_back({0, static_cast<std::uint32_t>(mesh.triangles.size()), -1});
    try {
        build();
    } catch (...) {
        release();
        throw;
    }
}

EmbreeScene::~EmbreeScene() {
    release();
}

void EmbreeScene::build() {
    const std::size_t direct = mesh_.instances.empty() ? parts_.size() : mesh_.firstSharedPart;
    // Without a number of threads, which would be that of the whole process while the device lives:
    // Embree builds in an arena as large as the caller's.
    device_ = rtcNewDevice(nullptr);
    if (!device_) throw Error("ray tracing: no device (Embree found no usable processor)");
    root_ = rtcNewScene(device_);
    // Robust: no ray slips between neighbouring triangles.
    rtcSetSceneFlags(root_, RTC_SCENE_FLAG_ROBUST);
    makeBuffers();
    for (const MeshPart& part : parts_)
        filtered_.push_back({&mesh_,
                             part.material < 0
                                 ? nullptr
                                 : &mesh_.materials[static_cast<std::size_t>(part.material)],
                             part.firstTriangle, this});
    for (std::size_t i = 0; i < direct; ++i) attachPart(root_, static_cast<unsigned>(i), parts_[i]);
    attachInstances(static_cast<unsigned>(direct));
    commit(root_);
    throwOnError();
}

void EmbreeScene::release() noexcept {
    if (root_) rtcReleaseScene(root_);
    for (RTCScene scene : shared_)
        if (scene) rtcReleaseScene(scene);
    if (corners_) rtcReleaseBuffer(corners_);
    if (indices_) rtcReleaseBuffer(indices_);
    if (device_) rtcReleaseDevice(device_);
}

void EmbreeScene::commit(RTCScene scene) {
    const auto goOn = [](void* watch, double) {
        return !mustEnd(static_cast<const Watch*>(watch));
    };
    rtcSetSceneProgressMonitorFunction(scene, goOn, currentWatch());
    rtcCommitScene(scene);
    rtcSetSceneProgressMonitorFunction(scene, nullptr, nullptr);
    throwIfInterrupted();
}

void EmbreeScene::throwOnError() const {
    if (rtcGetDeviceError(device_) != RTC_ERROR_NONE)
        throw Error("ray tracing: building the acceleration structure failed (out of memory?)");
}

void EmbreeScene::makeBuffers() {
    // Embree reads 16 bytes a corner; a copy of its own carries the padding.
    constexpr std::size_t kPadding = 16;
    corners_ = rtcNewBuffer(device_, sizeof(Vec3f) * mesh_.positions.size() + kPadding);
    indices_ = rtcNewBuffer(device_, sizeof(Vec3i) * mesh_.triangles.size() + kPadding);
    if (!corners_ || !indices_) throwOnError();
    std::uninitialized_copy(mesh_.positions.begin(), mesh_.positions.end(),
                            static_cast<Vec3f*>(rtcGetBufferData(corners_)));
    std::uninitialized_copy(mesh_.triangles.begin(), mesh_.triangles.end(),
                            static_cast<Vec3i*>(rtcGetBufferData(indices_)));
}

void EmbreeScene::attachPart(RTCScene scene, unsigned id, const MeshPart& part) {
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, corners_, 0,
                         sizeof(Vec3f), mesh_.positions.size());
    rtcSetGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, indices_,
                         sizeof(Vec3i) * part.firstTriangle, sizeof(Vec3i), part.triangleCount);
    Part& filtered = filtered_[static_cast<std::size_t>(&part - parts_.data())];
    if (const Material* material = filtered.material) {
        rtcSetGeometryUserData(geometry, &filtered);
        if (material->isPierced()) rtcSetGeometryOccludedFilterFunction(geometry, filterHoles);
        if (material->isPierced() || !material->doubleSided)
            rtcSetGeometryIntersectFilterFunction(geometry, filterUnseen);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene, geometry, id);
    rtcReleaseGeometry(geometry);
}

void EmbreeScene::attachInstances(unsigned firstId) {
    firstInstance_ = firstId;
    shared_.resize(parts_.size(), nullptr);
    for (std::size_t i = 0; i < mesh_.instances.size(); ++i) {
        const MeshInstance& instance = mesh_.instances[i];
        // A moving thing without extent is hidden.
        if (!instance.toWorld.invertible()) continue;
        RTCScene& shared = shared_[instance.firstPart];
        if (!shared) {
            shared = rtcNewScene(device_);
            rtcSetSceneFlags(shared, RTC_SCENE_FLAG_ROBUST);
            for (std::uint32_t k = 0; k < instance.partCount; ++k)
                attachPart(shared, k, parts_[instance.firstPart + k]);
            commit(shared);
        }
        RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_INSTANCE);
        rtcSetGeometryInstancedScene(geometry, shared);
        float map[12];
        const Affine& a = instance.toWorld;
        const Vec3d columns[4] = {a.axis[0], a.axis[1], a.axis[2], a.position};
        for (int c = 0; c < 4; ++c)
            for (int r = 0; r < 3; ++r) map[3 * c + r] = static_cast<float>(columns[c][r]);
        rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, map);
        rtcCommitGeometry(geometry);
        rtcAttachGeometryByID(root_, geometry, firstId + static_cast<unsigned>(i));
        rtcReleaseGeometry(geometry);
    }
}

std::uint32_t EmbreeScene::placedNumber(const RTCHit& hit) const noexcept {
    if (hit.instID[0] == RTC_INVALID_GEOMETRY_ID)
        return parts_[hit.geomID].firstTriangle + hit.primID;
    const MeshInstance& instance = mesh_.instances[hit.instID[0] - firstInstance_];
    return instance.firstPlaced + parts_[instance.firstPart + hit.geomID].firstTriangle -
           parts_[instance.firstPart].firstTriangle + hit.primID;
}

float EmbreeScene::cosineAt(const RTCFilterFunctionNArguments& hits, unsigned ray,
                            std::uint32_t triangle) const noexcept {
    const Vec3i& t = mesh_.triangles[triangle];
    const auto corner = [&](int k) { return mesh_.positions[static_cast<std::size_t>(t[k])]; };
    std::array<Vec3f, 3> v{
        corner(1) - corner(0), corner(2) - corner(0),
        Vec3f(RTCRayN_dir_x(hits.ray, hits.N, ray), RTCRayN_dir_y(hits.ray, hits.N, ray),
              RTCRayN_dir_z(hits.ray, hits.N, ray))};
    const unsigned instance = RTCHitN_instID(hits.hit, hits.N, ray, 0);
    if (instance != RTC_INVALID_GEOMETRY_ID) {
        const Affine& a = mesh_.instances[instance - firstInstance_].toWorld;
        for (Vec3f& x : v)
            x = Vec3f(a.axis[0]) * x.x + Vec3f(a.axis[1]) * x.y + Vec3f(a.axis[2]) * x.z;
    }
    const Vec3f normal = v[0].cross(v[1]);
    return normal.dot(v[2]) / std::sqrt(normal.length2() * v[2].length2());
}

/// Whether a ray passes the surface that it meets: a hole, or by chance.
bool EmbreeScene::passes(const Part& part, const RTCFilterFunctionNArguments& hits, unsigned ray) {
    const Material& material = *part.material;
    const auto& context = *reinterpret_cast<const QueryContext*>(hits.context);
    const std::uint32_t triangle = part.firstTriangle + RTCHitN_primID(hits.hit, hits.N, ray);
    const unsigned number = RTCRayN_id(hits.ray, hits.N, ray);
    const float cosine = material.isPane() ? part.scene->cosineAt(hits, ray, triangle) : 1.0f;
    const Passage passage =
        passageAt(*part.mesh, material, triangle, RTCHitN_u(hits.hit, hits.N, ray),
                  RTCHitN_v(hits.hit, hits.N, ray), cosine);
    if (context.tint) {
        *context.tint *= passage.tint;
        return true;
    }
    if (context.crossings) {
        if (passage.stopped <= 0 || passage.stopped >= 1) return passage.stopped <= 0;
        context.crossings->push_back({number, RTCRayN_tfar(hits.ray, hits.N, ray),
                                      rtcGetHitFromHitN(hits.hit, hits.N, ray)});
        return true;
    }
    float chance = 0;
    if (material.passesByChance())
        chance = toUnitFloat(static_cast<std::uint32_t>(
            hashWords(number, triangle, RTCHitN_instID(hits.hit, hits.N, ray, 0))));
    return passage.stopped <= chance;
}

void EmbreeScene::filterHoles(const RTCFilterFunctionNArguments* hits) {
    const Part& part = *static_cast<const Part*>(hits->geometryUserPtr);
    for (unsigned i = 0; i < hits->N; ++i)
        if (hits->valid[i] == -1 && passes(part, *hits, i)) hits->valid[i] = 0;
}

/// In the geometry's own space, so that a mirroring instance turns no side around.
bool EmbreeScene::isBackOf(const Part& part, const RTCFilterFunctionNArguments& hits,
                           unsigned ray) {
    const Vec3i& t =
        part.mesh->triangles[part.firstTriangle + RTCHitN_primID(hits.hit, hits.N, ray)];
    const auto corner = [&](int k) { return part.mesh->positions[static_cast<std::size_t>(t[k])]; };
    const Vec3f normal = (corner(1) - corner(0)).cross(corner(2) - corner(0));
    const Vec3f direction(RTCRayN_dir_x(hits.ray, hits.N, ray),
                          RTCRayN_dir_y(hits.ray, hits.N, ray),
                          RTCRayN_dir_z(hits.ray, hits.N, ray));
    return normal.dot(direction) > 0;
}

void EmbreeScene::filterUnseen(const RTCFilterFunctionNArguments* hits) {
    const Part& part = *static_cast<const Part*>(hits->geometryUserPtr);
    const bool culls = !part.material->doubleSided &&
                       reinterpret_cast<const QueryContext*>(hits->context)->fromCamera;
    for (unsigned i = 0; i < hits->N; ++i) {
        if (hits->valid[i] != -1) continue;
        if ((culls && isBackOf(part, *hits, i)) ||
            (part.material->isPierced() && passes(part, *hits, i)))
            hits->valid[i] = 0;
    }
}

}  // namespace shadowcache
