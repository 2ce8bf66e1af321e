#include "common/emitters/emitters.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/emitters/emitted.h"
#include "common/mesh/placed_mesh.h"

namespace shadowcache {

namespace {

/// Least that neighbours may emit towards a place, as a share: what is between their normals.
constexpr float kLeastTowards = 0.05f;

/// Radius that counts for a point that is where it lights.
constexpr float kLeastRadius = 1e-9f;

constexpr double kBelowOne = 1 - 0x1p-53;

using Form = EmitterPart::Form;

/// Whether parts are of one area, of which a ray meets one place: that on the edge of two triangles
/// counts once.
bool areOneArea(const EmitterPart& a, const EmitterPart& b) {
    return a.form == Form::triangle && b.form == Form::triangle && a.mesh == b.mesh &&
           a.lamp == b.lamp;
}

/// Whether a ray comes near a ball, by more than rounding could hide.
bool isNearBall(const Vec3f& origin, const Vec3f& direction, const Vec3f& centre, float radius) {
    constexpr float kWider = 1.01f, kRounding = 1e-4f;
    const Vec3f way = centre - origin;
    const float along = std::max(0.0f, way.dot(direction)), distance = way.length();
    const float reach = kWider * radius + kRounding * distance;
    return (way - direction * along).length2() <= reach * reach;
}

}  // namespace

std::span<const EmitterPart> Emitters::partsOf(std::size_t emitter) const {
    const Node& root = nodes_[roots_[emitter]];
    return std::span(parts_).subspan(root.begin, root.end - root.begin);
}

std::ptrdiff_t Emitters::find(std::uint32_t mesh, std::uint32_t placed) const {
    const std::pair<std::uint64_t, std::uint32_t> wanted{std::uint64_t{mesh} << 32 | placed, 0};
    const auto at = std::ranges::lower_bound(byPlace_, wanted);
    if (at == byPlace_.end() || at->first != wanted.first) return -1;
    return static_cast<std::ptrdiff_t>(at->second);
}

EmitterPoint Emitters::sample(const EmitterPart& t, const Receiver& at, double u,
                              double v) const noexcept {
    return t.table == EmitterPart::kNoTable ? samplePoint(t, at, u, v)
                                            : tables_[t.table].sample(t, at, u, v);
}

float Emitters::densityAt(const EmitterPart& triangle, const Receiver& at,
                          const Vec3f& position) const noexcept {
    return triangle.table == EmitterPart::kNoTable
               ? shadowcache::densityAt(triangle, at, position)
               : tables_[triangle.table].densityAt(triangle, at, position);
}

const std::string& Emitters::nameOf(const EmitterPart& part) const {
    const TriangleMesh& mesh = *meshes_[part.mesh];
    return part.isSurface() ? materialOf(mesh, placedTriangle(mesh, part.placed).triangle)->name
                            : mesh.lamps[part.lamp].name;
}

Rgb Emitters::radianceAt(const EmitterPart& t, const EmitterPoint& point) const noexcept {
    if (!t.varies) return t.radiance * point.share;
    const TriangleMesh& mesh = *meshes_[t.mesh];
    return emittedAt(mesh, placedTriangle(mesh, t.placed).triangle, point.u, point.v);
}

/// Weight times projected area as seen from a direction w. Points and suns: all of it. Triangles
/// with two sides: by the root of the mean square of the cosines, which is right for what is flat.
/// With one: half of that and of the sum of normals . w, since max(0, x) = (|x| + x) / 2.
float Emitters::Node::towards(const Vec3f& w) const noexcept {
    if (form != Form::triangle) return weight;
    const float square =
        spread[0] * w.x * w.x + spread[1] * w.y * w.y + spread[2] * w.z * w.z +
        2 * (spread[3] * w.x * w.y + spread[4] * w.y * w.z + spread[5] * w.z * w.x);
    const float both = std::sqrt(std::max(0.0f, square * weight));
    const float oneSided = 0.5f * ((1 - twoSidedShare) * both + facing.dot(w));
    return twoSidedShare * both + std::max(0.0f, oneSided);
}

Unoccluded Emitters::irradianceOf(const Node& node, const Receiver& at) const noexcept {
    const Vec3f way = node.centre - at.position;
    const float squared = way.length2(), height = at.normal.dot(way);
    if (!(node.weight > 0) || isBelow(height, node.radius)) return {};
    if (node.end > node.begin + 1 && !node.hasCones && !node.hasSlats &&
        squared > kFarRadii * kFarRadii * node.radius * node.radius &&
        std::abs(height) > node.radius) {
        if (height < 0) return {};
        const float distance = std::sqrt(squared);
        const float turned = node.towards(way * (-1 / distance)) / node.weight;
        const float share = std::max(turned, 1e-12f) * (height / distance) / squared;
        return {node.flux * share, node.weight * share};
    }
    Unoccluded sum;
    const auto add = [&sum](const Unoccluded& more) {
        sum.irradiance += more.irradiance;
        sum.weight += more.weight;
    };
    if (node.left != 0) {
        add(irradianceOf(nodes_[node.left], at));
        add(irradianceOf(nodes_[node.left + 1], at));
    } else {
        for (std::uint32_t i = node.begin; i < node.end; ++i) add(irradianceBy(parts_[i], at));
    }
    return sum;
}

Unoccluded Emitters::irradiance(std::size_t emitter, const Receiver& at) const noexcept {
    return irradianceOf(nodes_[roots_[emitter]], at);
}

/// What slats leave of what is in a node, about.
float Emitters::slatShareOf(const Node& node, const Receiver& at) const noexcept {
    if (!node.hasSlats) return 1;
    float left = 0, all = 0;
    for (std::uint32_t i = node.begin; i < node.end; ++i) {
        left += parts_[i].area * shadowcache::slatShareOf(parts_[i], at.position);
        all += parts_[i].area;
    }
    return left / all;
}

float Emitters::roughWeightOf(const Node& node, const Receiver& at) const noexcept {
    const Vec3f way = node.centre - at.position;
    const float squared = way.length2(), height = at.normal.dot(way);
    if (!(node.weight > 0) || isBelow(height, node.radius)) return 0;
    if (node.end > node.begin + 1 && !node.hasCones &&
        squared > kRoughRadii * kRoughRadii * node.radius * node.radius &&
        (!node.hasSlats || hasSlightSlats(parts_[node.begin], at.position, node.radius))) {
        const float turned =
            std::max(node.towards(way * (-1 / std::sqrt(squared))), kLeastTowards * node.weight);
        return turned * (meanHeight(height, node.radius) / squared) / std::sqrt(squared) *
               slatShareOf(node, at);
    }
    if (node.left != 0)
        return roughWeightOf(nodes_[node.left], at) + roughWeightOf(nodes_[node.left + 1], at);
    float sum = 0;
    for (std::uint32_t i = node.begin; i < node.end; ++i) sum += roughWeightBy(parts_[i], at);
    return sum;
}

float Emitters::roughWeight(std::size_t emitter, const Receiver& at) const noexcept {
    return roughWeightOf(nodes_[roots_[emitter]], at);
}

/// What some parts may be worth to a place: above 0 wherever they are worth something.
float Emitters::boundOf(const Node& node, const Receiver& at) const noexcept {
    if (node.form == Form::sun) return node.weight;
    const Vec3f way = node.centre - at.position;
    const float squared = way.length2(), height = at.normal.dot(way) + node.radius;
    if (height <= 0 || !(node.weight > 0)) return 0;
    const float distance = std::sqrt(squared);
    if (distance <= node.radius || !(squared > 0)) {
        const float radius = std::max(node.radius, kLeastRadius);
        return slatShareOf(node, at) * node.weight / (radius * radius);
    }
    const float turned = std::max(node.towards(way * (-1 / distance)), kLeastTowards * node.weight);
    return slatShareOf(node, at) * turned * std::min(1.0f, height / distance) / squared;
}

template <class GoLeft, class Pick>
Emitters::Choice Emitters::walk(std::size_t emitter, const Receiver& at, const GoLeft& goLeft,
                                const Pick& pick) const noexcept {
    const Node* node = &nodes_[roots_[emitter]];
    float chance = 1;
    while (node->left != 0) {
        const float left = boundOf(nodes_[node->left], at);
        const float sum = left + boundOf(nodes_[node->left + 1], at);
        if (!(sum > 0)) return {};
        const bool isLeft = goLeft(nodes_[node->left], left / sum);
        chance *= isLeft ? left / sum : 1 - left / sum;
        node = &nodes_[node->left + (isLeft ? 0 : 1)];
    }
    std::array<float, kLeaf> weights{};
    float sum = 0;
    const std::uint32_t count = node->end - node->begin;
    for (std::uint32_t i = 0; i < count; ++i)
        sum += weights[i] = roughWeightBy(parts_[node->begin + i], at);
    if (!(sum > 0)) return {};
    const std::uint32_t i = pick(node->begin, std::span<const float>(weights).first(count), sum);
    return {node->begin + i, chance * (weights[i] / sum)};
}

Emitters::Choice Emitters::choose(std::size_t emitter, const Receiver& at,
                                  double& u) const noexcept {
    const auto goLeft = [&u](const Node&, float chance) {
        const auto c = static_cast<double>(chance);
        const bool left = u < c;
        u = std::min(left ? u / c : (u - c) / (1 - c), kBelowOne);
        return left;
    };
    const auto pick = [&u](std::uint32_t, std::span<const float> weights, float sum) {
        double rest = u * static_cast<double>(sum);
        std::uint32_t i = 0, last = 0;
        for (; i < weights.size(); ++i) {
            const auto weight = static_cast<double>(weights[i]);
            if (weight > 0) last = i;
            if (rest < weight) break;
            rest -= weight;
        }
        // Rounding may leave something behind the last one.
        if (i == weights.size()) i = last;
        u = std::clamp(rest / static_cast<double>(weights[i]), 0.0, kBelowOne);
        return i;
    };
    return walk(emitter, at, goLeft, pick);
}

float Emitters::chanceOf(std::size_t part, const Receiver& at) const noexcept {
    const auto goLeft = [part](const Node& left, float) {
        return part >= left.begin && part < left.end;
    };
    const auto pick = [part](std::uint32_t first, std::span<const float>, float) {
        return static_cast<std::uint32_t>(part) - first;
    };
    return walk(emitterOf_[part], at, goLeft, pick).chance;
}

void Emitters::meetLampsOf(const Node& node, const Receiver& at, const Vec3f& direction,
                           std::vector<Met>& met) const {
    if (!node.hasLamps) return;
    if (std::isfinite(node.radius) && !isNearBall(at.position, direction, node.centre, node.radius))
        return;
    if (node.left != 0) {
        meetLampsOf(nodes_[node.left], at, direction, met);
        meetLampsOf(nodes_[node.left + 1], at, direction, met);
        return;
    }
    for (std::uint32_t i = node.begin; i < node.end; ++i) {
        if (!parts_[i].isLampToMeet()) continue;
        const auto isKnown = [&](const Met& other) {
            return areOneArea(parts_[other.part], parts_[i]);
        };
        if (const auto hit = meetLamp(parts_[i], at, direction);
            hit && std::ranges::none_of(met, isKnown))
            met.push_back({i, *hit});
    }
}

void Emitters::meetLamps(const Receiver& at, const Vec3f& direction, std::vector<Met>& met) const {
    for (const std::uint32_t root : roots_) meetLampsOf(nodes_[root], at, direction, met);
}

}  // namespace shadowcache
