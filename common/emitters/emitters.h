#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/emitters/emitter_part.h"
#include "common/emitters/found_parts.h"

namespace shadowcache {

/// Most emitters of a set, and of the lamps that move in it: where more surfaces and lamps shine,
/// near ones are one emitter.
inline constexpr std::size_t kMostEmitters = 32;

/// All that emits in a set, and what moves in it, as emitters: connected triangles of one material,
/// and lamps, or, where there are many, neighbours of one form. Parts of an emitter are a tree, as
/// lights are in [Conty Estevez & Kulla 2018]. Lamps that move come last, and change no other.
/// Immutable, thread-safe.
class Emitters {
public:
    /// @param meshes  of one origin; outlive this object
    explicit Emitters(std::span<const TriangleMesh* const> meshes,
                      EmitterWeight weight = EmitterWeight::radiance);

    /// Number of emitters.
    std::size_t size() const { return roots_.size(); }
    bool empty() const { return roots_.empty(); }

    std::span<const EmitterPart> parts() const { return parts_; }
    /// Those of an emitter.
    std::span<const EmitterPart> partsOf(std::size_t emitter) const;
    /// The emitter of a part.
    std::size_t emitterOf(std::size_t part) const { return emitterOf_[part]; }
    /// Number of a triangle of the world among parts(), or -1 if it does not emit.
    std::ptrdiff_t find(std::uint32_t mesh, std::uint32_t placed) const;

    /// Whether an emitter is of lamps that move.
    bool moves(std::size_t emitter) const { return partsOf(emitter).front().moves; }

    /// Name of a part's lamp, or of the material of a surface; may be empty.
    const std::string& nameOf(const EmitterPart& part) const;

    /// Hash of an emitter's place and shape: the same whatever it emits.
    std::uint64_t shapeOf(std::size_t emitter) const { return shapes_[emitter]; }

    /// Irradiance of a place by an emitter: within 2 per cent, or exact where it is near.
    Unoccluded irradiance(std::size_t emitter, const Receiver& at) const noexcept;

    /// irradiance() by EmitterPart::weight, roughly where the emitter is not near: above 0 wherever
    /// there is any. For chances.
    float roughWeight(std::size_t emitter, const Receiver& at) const noexcept;

    /// A part, and the chance with which it was chosen of its emitter's.
    struct Choice {
        std::uint32_t part = 0;
        float chance = 0;  ///< 0: there is none to choose
    };
    /// Chooses a part of an emitter, in proportion to its light at a place, about.
    ///
    /// @param u  in [0, 1); becomes another such number
    Choice choose(std::size_t emitter, const Receiver& at, double& u) const noexcept;
    /// Chance with which choose() takes a part of its emitter.
    float chanceOf(std::size_t part, const Receiver& at) const noexcept;

    /// A lamp that a ray meets.
    struct Met {
        std::uint32_t part = 0;
        LampHit hit;
    };
    /// Finds the lamps with an extent that a ray meets, whatever is in the way, each once. Appends.
    ///
    /// @param direction  unit
    void meetLamps(const Receiver& at, const Vec3f& direction, std::vector<Met>& met) const;

    /// Whether cameras see some lamp.
    bool hasSeenLamps() const { return hasSeenLamps_; }

    /// Draws a point of a part as samplePoint() does, or by the table of a triangle that has one.
    EmitterPoint sample(const EmitterPart& t, const Receiver& at, double u,
                        double v) const noexcept;
    /// Density with which sample() draws a point of a triangle [1/sr].
    float densityAt(const EmitterPart& triangle, const Receiver& at,
                    const Vec3f& position) const noexcept;

    /// Radiance of a part at a point of it; of a single direction times its solid angle.
    Rgb radianceAt(const EmitterPart& t, const EmitterPoint& point) const noexcept;

private:
    /// Parts of a leaf of the tree, at most.
    static constexpr std::uint32_t kLeaf = 8;

    /// Parts that are neighbours. Sums are by weight times area.
    struct Node {
        std::uint32_t begin = 0, end = 0;  ///< of parts_
        std::uint32_t left = 0;  ///< the first of its two children, which are neighbours; 0: none
        EmitterPart::Form form = EmitterPart::Form::triangle;
        bool isMixed = false;   ///< has other forms, too: always divided
        bool hasCones = false;  ///< some are spots, or have slats that are not all of one lamp
        bool hasSlats = false;  ///< all are of one lamp, which has slats
        bool hasLamps = false;  ///< some are lamps with an extent
        Vec3f centre{0, 0, 0};
        float radius = 0;         ///< infinite of suns, and of what is mixed
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
    void cut(std::uint32_t root, const std::vector<std::uint32_t>& groupsOfNode);
    void findShapes();
    Unoccluded irradianceOf(const Node& node, const Receiver& at) const noexcept;
    float roughWeightOf(const Node& node, const Receiver& at) const noexcept;
    float slatShareOf(const Node& node, const Receiver& at) const noexcept;
    float boundOf(const Node& node, const Receiver& at) const noexcept;
    void meetLampsOf(const Node& node, const Receiver& at, const Vec3f& direction,
                     std::vector<Met>& met) const;
    /// Walks from an emitter to one of its parts: `goLeft` gets the chance of the left one of two
    /// children, `pick` the weights of a leaf's parts and their sum, and returns one's number.
    /// @return the part and its chance
    template <class GoLeft, class Pick>
    Choice walk(std::size_t emitter, const Receiver& at, const GoLeft& goLeft,
                const Pick& pick) const noexcept;

    std::vector<const TriangleMesh*> meshes_;
    std::vector<EmitterPart> parts_;
    std::vector<EmissionTable> tables_;
    std::vector<std::uint32_t> emitterOf_;
    std::vector<Node> nodes_;
    std::vector<std::uint32_t> roots_;  ///< by emitter: its node
    std::vector<std::uint64_t> shapes_;
    std::vector<std::pair<std::uint64_t, std::uint32_t>> byPlace_;  ///< sorted: mesh and number
    bool hasSeenLamps_ = false;
};

}  // namespace shadowcache
