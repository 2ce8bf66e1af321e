#pragma once

#include <embree3/rtcore.h>

#include <cstdint>
#include <vector>

#include "common/mesh/mesh.h"

namespace shadowcache {

// Names Embree's types; for scene.cpp and embree_scene.cpp only.

/// Where a ray meets a surface that it may pass by chance.
struct ChanceHit {
    unsigned ray;  ///< RTCRay::id
    float distance;
    RTCHit hit;
};

/// What a query that may call the filters below hands to them.
struct QueryContext {
    RTCIntersectContext base;
    bool fromCamera = false;  ///< backs of surfaces that are not double-sided are not seen
    Rgb* tint = nullptr;      ///< of a single ray that passes all that is pierced: what it gathers
    /// Of rays that pass all that they may pass: what that is, in any order, and some that lies
    /// beyond what they meet. Null: each passes by its own chance.
    std::vector<ChanceHit>* crossings = nullptr;

    QueryContext() { rtcInitIntersectContext(&base); }
};

/// A mesh in Embree: a geometry for each part in the world, an instance for each of the mesh's.
/// Only geometries whose material needs them have filters, so others lose nothing.
class EmbreeScene {
public:
    /// @throws Error when memory runs out, Interrupted if the caller has asked to stop
    explicit EmbreeScene(const TriangleMesh& mesh);
    ~EmbreeScene();
    EmbreeScene(const EmbreeScene&) = delete;
    EmbreeScene& operator=(const EmbreeScene&) = delete;

    RTCScene root() const { return root_; }

    /// Number in the world of the triangle that was hit (placed_mesh.h).
    std::uint32_t placedNumber(const RTCHit& hit) const noexcept;

private:
    /// What the filters know of their geometry.
    struct Part {
        const TriangleMesh* mesh;
        const Material* material;
        std::uint32_t firstTriangle;
        const EmbreeScene* scene;
    };

    static void filterHoles(const RTCFilterFunctionNArguments* hits);
    static void filterUnseen(const RTCFilterFunctionNArguments* hits);
    static bool passes(const Part& part, const RTCFilterFunctionNArguments& hits, unsigned ray);
    static bool isBackOf(const Part& part, const RTCFilterFunctionNArguments& hits, unsigned ray);
    /// Cosine, in the world, between a ray and the normal of the triangle that it meets.
    float cosineAt(const RTCFilterFunctionNArguments& hits, unsigned ray,
                   std::uint32_t triangle) const noexcept;

    void build();
    void release() noexcept;
    void makeBuffers();
    void attachPart(RTCScene scene, unsigned id, const MeshPart& part);
    void attachInstances(unsigned firstId);
    /// Ends soon once who watches the thread asks for it. @throws Interrupted
    void commit(RTCScene scene);
    void throwOnError() const;

    const TriangleMesh& mesh_;
    std::vector<MeshPart> parts_;  ///< the mesh's, at least one
    std::vector<Part> filtered_;   ///< by part
    RTCDevice device_ = nullptr;
    RTCBuffer corners_ = nullptr, indices_ = nullptr;
    RTCScene root_ = nullptr;
    std::vector<RTCScene> shared_;  ///< by first part; null where no instance begins
    unsigned firstInstance_ = 0;    ///< its number as a geometry of the root
};

}  // namespace shadowcache
