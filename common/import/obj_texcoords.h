#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "common/import/gltf_material.h"
#include "common/import/mesh_reader.h"
#include "common/import/texture_islands.h"

namespace shadowcache {

/// Corners of a run of faces.
struct ObjCorners {
    std::size_t firstFace = 0;
    std::size_t endFace = 0;  ///< behind the last
    std::size_t firstCorner = 0;
};

/// Gives the corners of faces their places on pictures, and tangents where there is a normal map.
/// Vertices that have several are split.
class ObjTexcoords {
public:
    /// @param texcoords      of the file: u, v
    /// @param faceTexcoords  of each corner of `mesh`, kNoVertex for none
    /// @param mesh           outlives this, as the others do
    ObjTexcoords(std::span<const Vec2d> texcoords, std::span<const std::uint32_t> faceTexcoords,
                 RawMesh& mesh);

    /// Places the corners of a run of faces of one material.
    void place(const ObjCorners& corners, const GltfMaterial& material);

    /// Fills up what no face has set, and makes the tangents.
    void finish();

private:
    static constexpr int kNoNormalMap = -1;

    /// What the vertices of a material depend on.
    struct Kind {
        std::vector<GltfTexturePlace> places;
        std::vector<Repeats> repeats;  ///< by place
        int normalMap = kNoNormalMap;  ///< its layer
        bool operator==(const Kind&) const = default;
    };

    /// Numbers of the texture coordinate, of the kind and, with a normal map, of the normal.
    using Use = std::array<std::uint32_t, 3>;
    static constexpr Use kUnused{kNoVertex, kNoVertex, kNoVertex};

    std::uint32_t vertexFor(std::uint32_t vertex, const Use& use);
    void write(std::uint32_t vertex, const Use& use);
    void addTriangles(const ObjCorners& corners, std::vector<std::uint32_t>& triangles) const;
    std::vector<Vec2f> placesIn(int layer) const;
    void addTangents();

    std::span<const Vec2d> texcoords_;
    std::span<const std::uint32_t> faceTexcoords_;
    TextureIslands islands_;
    RawMesh& mesh_;
    std::vector<Use> uses_;  ///< by vertex of the file: its first
    std::map<std::array<std::uint32_t, 4>, std::uint32_t> copies_;
    std::vector<Kind> kinds_;
    std::map<int, std::vector<std::uint32_t>> bent_;  ///< triangles with a normal map, by its layer
    std::vector<Vec3d> normals_;                      ///< of their vertices
};

}  // namespace shadowcache
