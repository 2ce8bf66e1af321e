#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "common/mesh/mesh.h"

namespace shadowcache {

/// A triangle that emits.
struct EmissiveTriangle {
    std::array<Vec3f, 3> corner{};  ///< relative to the mesh's origin
    Vec3f centre{0};
    float radius = 0;  ///< of the ball around the centre that holds it
    float size = 0;    ///< length of its longest side
    Vec3f normal{0};   ///< unit, by its winding in the file
    float area = 0;
    Rgb radiance{0, 0, 0};     ///< in the mean over it
    float weight = 0;          ///< luminance by which it is chosen: above 0 wherever it emits
    std::uint32_t mesh = 0;    ///< which of the meshes it is of
    std::uint32_t placed = 0;  ///< its number in the world (placed_mesh.h)
    bool twoSided = false;     ///< emits on both sides
    bool varies = false;       ///< its radiance is not the same everywhere
};

/// What a place needs to be lit: relative to the mesh's origin.
struct Receiver {
    Vec3f position;
    Vec3f normal;  ///< unit; light comes from above the plane across it
};

/// Irradiance of a place by one emitter, if nothing is in the way.
struct Unoccluded {
    Rgb irradiance{0, 0, 0};
    float weight = 0;  ///< the same by EmissiveTriangle::weight: above 0 wherever there is any
};

/// Most emitters of a set: where more surfaces shine, near ones are one emitter.
inline constexpr std::size_t kMostEmitters = 32;

/// All that emits in a set, and what moves in it, as emitters: connected triangles of one material
/// or, where there are many, neighbours. Triangles of an emitter are a tree, as lights are in
/// [Conty Estevez & Kulla 2018]. Immutable, thread-safe.
class Emitters {
public:
    /// What triangles are weighed by.
    enum class Weigh {
        radiance,  ///< what they emit
        shape      ///< each alike
    };

    /// @param meshes  of one origin; outlive this object
    explicit Emitters(std::span<const TriangleMesh* const> meshes, Weigh weigh = Weigh::radiance);

    /// Number of emitters.
    std::size_t size() const { return roots_.size(); }
    bool empty() const { return roots_.empty(); }

    std::span<const EmissiveTriangle> triangles() const { return triangles_; }
    /// Those of an emitter.
    std::span<const EmissiveTriangle> trianglesOf(std::size_t emitter) const;
    /// The emitter of a triangle.
    std::size_t emitterOf(std::size_t triangle) const { return emitterOf_[triangle]; }
    /// Number of a triangle of the world among triangles(), or -1 if it does not emit.
    std::ptrdiff_t find(std::uint32_t mesh, std::uint32_t placed) const;

    /// Hash of an emitter's place and shape: the same whatever it emits.
    std::uint64_t shapeOf(std::size_t emitter) const { return shapes_[emitter]; }

    /// Irradiance of a place by an emitter: within 2 per cent, or exact where it is near.
    Unoccluded irradiance(std::size_t emitter, const Receiver& at) const noexcept;

    /// A triangle, and the chance with which it was chosen of its emitter's.
    struct Choice {
        std::uint32_t triangle = 0;
        float chance = 0;  ///< 0: there is none to choose
    };
    /// Chooses a triangle of an emitter, in proportion to its light at a place, about.
    ///
    /// @param u  in [0, 1); becomes another such number
    Choice choose(std::size_t emitter, const Receiver& at, double& u) const noexcept;
    /// Chance with which choose() takes a triangle of its emitter.
    float chanceOf(std::size_t triangle, const Receiver& at) const noexcept;

    /// Radiance of a triangle at barycentric coordinates.
    Rgb radianceAt(const EmissiveTriangle& t, float u, float v) const noexcept;

private:
    /// Triangles that are neighbours. Sums are by weight times area.
    struct Node {
        std::uint32_t begin = 0, end = 0;  ///< of triangles_
        std::uint32_t left = 0;  ///< the first of its two children, which are neighbours; 0: none
        Vec3f centre{0, 0, 0};
        float radius = 0;
        Rgb flux{0, 0, 0};        ///< sum of radiance times area
        float weight = 0;         ///< sum
        Vec3f facing{0, 0, 0};    ///< sum of the normals of what emits on one side
        float spread[6] = {};     ///< sum of their products: xx, yy, zz, xy, yz, zx
        float twoSidedShare = 0;  ///< of the weight

        float towards(const Vec3f& direction) const noexcept;
    };
    struct Builder;

    Node summed(std::uint32_t begin, std::uint32_t end) const;
    void indexPlaces();
    void cut(const std::vector<std::uint32_t>& groupsOfNode);
    void findShapes();
    Unoccluded irradianceOf(const Node& node, const Receiver& at) const noexcept;
    static float boundOf(const Node& node, const Receiver& at) noexcept;
    /// Walks from an emitter to one of its triangles: `goLeft` gets the chance of the left one of
    /// two children, `pick` the weights of a leaf's triangles and their sum, and returns one's
    /// number.
    /// @return the triangle and its chance
    template <class GoLeft, class Pick>
    Choice walk(std::size_t emitter, const Receiver& at, const GoLeft& goLeft,
                const Pick& pick) const noexcept;

    std::vector<const TriangleMesh*> meshes_;
    std::vector<EmissiveTriangle> triangles_;
    std::vector<std::uint32_t> emitterOf_;
    std::vector<Node> nodes_;
    std::vector<std::uint32_t> roots_;  ///< by emitter: its node
    std::vector<std::uint64_t> shapes_;
    std::vector<std::pair<std::uint64_t, std::uint32_t>> byPlace_;  ///< sorted: mesh and number
};

/// Irradiance of a place by a triangle, likewise.
Unoccluded irradianceBy(const EmissiveTriangle& t, const Receiver& at) noexcept;

/// A point of a triangle that a place is lit from.
struct EmitterPoint {
    float u = 0, v = 0;  ///< barycentric coordinates
    Vec3f position{0};   ///< relative to the mesh's origin
    Vec3f direction{0};  ///< unit, towards it
    float density = 0;   ///< with which it is drawn [1/sr]; 0: the place does not see it
};

/// Draws a point of a triangle: uniform in solid angle where the triangle is near, else in area.
///
/// @param u, v  in [0, 1)
EmitterPoint samplePoint(const EmissiveTriangle& t, const Receiver& at, double u,
                         double v) noexcept;

/// Density with which samplePoint() draws a point of a triangle [1/sr].
float densityAt(const EmissiveTriangle& t, const Receiver& at, const Vec3f& position) noexcept;

}  // namespace shadowcache
