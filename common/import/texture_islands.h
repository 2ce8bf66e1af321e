#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "common/import/gltf_material.h"

namespace shadowcache {

/// Texture coordinates as a file has them.
using Vec2d = Imath::V2d;

/// Whether textures repeat along s, and along t.
using Repeats = std::array<bool, 2>;

/// Of a material's layers: whether all of its textures there do.
std::vector<Repeats> repeatsOf(const GltfMaterial& material,
                               const std::function<const Texture&(int)>& texture);

/// Places on textures in float. Of coordinates far from 0, whole periods are taken off before they
/// are rounded, the same of all that faces connect: as far out as some programs put them, float has
/// no fraction left.
class TextureIslands {
public:
    /// @param places   outlive this
    /// @param corners  numbers in `places` of the corners of faces, face after face; others are
    /// passed over
    /// @param sizes    numbers of corners of the faces
    TextureIslands(std::span<const Vec2d> places, std::span<const std::uint32_t> corners,
                   std::span<const std::uint32_t> sizes);

    /// Of places[number].
    Vec2f at(std::size_t number, const GltfTexturePlace& on, const Repeats& repeats) const;

    /// Of what has no coordinates.
    static Vec2f none(const GltfTexturePlace& on);

private:
    std::span<const Vec2d> places_;
    std::vector<std::uint32_t> island_;  ///< by place; empty: all are of one
    std::vector<Vec2d> middle_;          ///< by island
};

}  // namespace shadowcache
