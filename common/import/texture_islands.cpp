#include "common/import/texture_islands.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace shadowcache {

namespace {

/// Nearer than that, float has bits for an eighth of a texel of 4096.
constexpr double kFarTurns = 256;

Vec2f inFloat(const GltfTexturePlace& on, const Vec3f& uv1) {
    return {Vec3f(on.toS).dot(uv1), Vec3f(on.toT).dot(uv1)};
}

/// An even number, so that mirrors stay what they are.
double periodsOf(double middle, bool repeats) {
    return repeats && std::abs(middle) >= kFarTurns ? 2 * std::round(middle / 2) : 0;
}

/// Disjoint sets. [Tarjan 1975, with path halving]
class Sets {
public:
    explicit Sets(std::size_t size) : parent_(size) {
        std::iota(parent_.begin(), parent_.end(), 0u);
    }

    std::uint32_t of(std::uint32_t i) {
        while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    void join(std::uint32_t a, std::uint32_t b) {
        const std::uint32_t x = of(a), y = of(b);
        parent_[std::max(x, y)] = std::min(x, y);
    }

private:
    std::vector<std::uint32_t> parent_;
};

}  // namespace

std::vector<Repeats> repeatsOf(const GltfMaterial& material,
                               const std::function<const Texture&(int)>& texture) {
    const Material& m = material.material;
    const Finish& f = m.finish;
    std::vector<Repeats> all(material.places.size(), {true, true});
    for (const TextureSlot& slot : {TextureSlot{m.texture, 0}, m.normal, f.metallicRoughness,
                                    f.specular, f.specularColor, f.emissionTexture}) {
        if (slot.texture < 0 || static_cast<std::size_t>(slot.layer) >= all.size()) continue;
        Repeats& repeats = all[static_cast<std::size_t>(slot.layer)];
        const Texture& on = texture(slot.texture);
        repeats[0] = repeats[0] && on.wrapS != Texture::Wrap::clamp;
        repeats[1] = repeats[1] && on.wrapT != Texture::Wrap::clamp;
    }
    return all;
}

TextureIslands::TextureIslands(std::span<const Vec2d> places,
                               std::span<const std::uint32_t> corners,
                               std::span<const std::uint32_t> sizes)
    : places_(places) {
    std::vector<Imath::Box2d> boxes(1);
    for (const Vec2d& p : places) boxes[0].extendBy(p);
    const auto isFar = [](const Vec2d& p) {
        return !(std::abs(p.x) < kFarTurns && std::abs(p.y) < kFarTurns);
    };
    if (std::ranges::any_of(places, isFar)) {
        Sets sets(places.size());
        const std::uint32_t* corner = corners.data();
        for (const std::uint32_t size : sizes) {
            for (std::uint32_t k = 1; k < size; ++k)
                if (corner[0] < places.size() && corner[k] < places.size())
                    sets.join(corner[0], corner[k]);
            corner += size;
        }
        boxes.assign(places.size(), {});
        island_.resize(places.size());
        for (std::uint32_t i = 0; i < places.size(); ++i) {
            island_[i] = sets.of(i);
            boxes[island_[i]].extendBy(places[i]);
        }
    }
    for (const Imath::Box2d& box : boxes)
        middle_.push_back(box.isEmpty() ? Vec2d(0.0) : (box.min + box.max) / 2);
}

Vec2f TextureIslands::at(std::size_t number, const GltfTexturePlace& on,
                         const Repeats& repeats) const {
    const Vec2d& uv = places_[number];
    const Vec2d& middle = middle_[island_.empty() ? 0 : island_[number]];
    const Vec3d middle1(middle.x, middle.y, 1), uv1(uv.x, uv.y, 1);
    const double offS = periodsOf(on.toS.dot(middle1), repeats[0]);
    const double offT = periodsOf(on.toT.dot(middle1), repeats[1]);
    if (offS == 0 && offT == 0) return inFloat(on, Vec3f(uv1));
    return {static_cast<float>(on.toS.dot(uv1) - offS), static_cast<float>(on.toT.dot(uv1) - offT)};
}

Vec2f TextureIslands::none(const GltfTexturePlace& on) {
    return inFloat(on, Vec3f(0, 0, 1));
}

}  // namespace shadowcache
