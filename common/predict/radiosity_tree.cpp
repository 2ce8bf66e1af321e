#include "common/predict/radiosity_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/parallel.h"

namespace shadowcache {

namespace {

/// Items that a thread takes at a time.
constexpr std::size_t kTreeChunk = 4096;

}  // namespace

/// An item that sends light.
struct RadiosityTree::Lit {
    Vec3f position, normal;
    float power;
};

RadiosityTree::RadiosityTree(const BounceSolve& solve, std::span<const ItemLook> looks, int bounces,
                             const Rgb& luminanceWeights, const Vec3d& origin)
    : solve_(solve),
      // Half the diagonal of a voxel.
      itemRadius_(static_cast<float>(0.5 * std::sqrt(3.0) * solve.items().spacing())),
      itemArea_(static_cast<float>(solve.items().spacing() * solve.items().spacing())),
      radiance_(solve.items().size()) {
    const ItemTable& items = solve.items();
    parallelFor(items.size(), kTreeChunk, [&](const Chunk& chunk) {
        for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
            const auto item = static_cast<std::uint32_t>(i);
            const Rgb sent = looks[i].albedo * solve.irradiance(item, bounces);
            radiance_[i] = std::max(0.0f, sent.dot(luminanceWeights)) * static_cast<float>(1 / kPi);
        }
    });
    std::vector<Lit> lit;
    for (std::uint32_t i = 0; i < items.size(); ++i) {
        const float power = radiance_[i] * itemArea_ * items.exposure(i);
        if (power > 0 && std::isfinite(power))
            lit.push_back({Vec3f(items.position(i) - origin), items.normal(i), power});
    }
    if (lit.empty()) return;
    nodes_.emplace_back();
    build(0, lit);
}

RadiosityTree::Node RadiosityTree::summed(std::span<const Lit> items) const {
    Node node;
    Imath::Box3f box;
    double power = 0;
    Vec3d facing(0);
    for (const Lit& item : items) {
        box.extendBy(item.position);
        power += static_cast<double>(item.power);
        facing += Vec3d(item.normal) * static_cast<double>(item.power);
    }
    node.ball = {box.center(), 0.5f * box.size().length() + itemRadius_};
    node.power = static_cast<float>(power);
    node.facing = Vec3f(facing / power);
    return node;
}

void RadiosityTree::build(std::size_t number, std::span<Lit> items) {
    nodes_[number] = summed(items);
    if (items.size() == 1) return;
    Imath::Box3f box;
    for (const Lit& item : items) box.extendBy(item.position);
    const auto axis = static_cast<int>(box.majorAxis());
    const std::size_t half = items.size() / 2;
    std::nth_element(
        items.begin(), items.begin() + static_cast<std::ptrdiff_t>(half), items.end(),
        [axis](const Lit& a, const Lit& b) { return a.position[axis] < b.position[axis]; });
    const std::size_t left = nodes_.size();
    nodes_[number].left = static_cast<std::uint32_t>(left);
    nodes_.resize(left + 2);
    build(left, items.first(half));
    build(left + 1, items.subspan(half));
}

/// About, and above 0 where some part of the ball may light the place.
float RadiosityTree::irradianceOf(const Node& node, const Vec3f& position, const Vec3f& normal) {
    const Vec3f way = node.ball.centre - position;
    const float squared = std::max(way.length2(), std::numeric_limits<float>::min());
    const float distance = std::sqrt(squared);
    const float slack = std::min(1.0f, node.ball.radius / distance);
    const float here = std::min(1.0f, normal.dot(way) / distance + slack);
    // Normals that differ face more than their mean does.
    const float there =
        std::min(1.0f, 1 - node.facing.length() + slack - node.facing.dot(way) / distance);
    if (here <= 0 || there <= 0) return 0;
    return node.power * here * there / std::max(squared, node.ball.radius * node.ball.radius);
}

std::vector<RadiosityTree::Ball> RadiosityTree::brightestFor(const Vec3f& position,
                                                             const Vec3f& normal,
                                                             std::size_t most) const {
    struct Part {
        float irradiance, urgency;  ///< of dividing it
        std::uint32_t node;
    };
    const auto part = [&](std::uint32_t number) {
        const Node& node = nodes_[number];
        const float irradiance = irradianceOf(node, position, normal);
        const float extent =
            node.ball.radius / std::max((node.ball.centre - position).length(), node.ball.radius);
        return Part{irradiance, node.left == 0 ? 0 : irradiance * extent, number};
    };
    const auto lessUrgent = [](const Part& a, const Part& b) { return a.urgency < b.urgency; };
    std::vector<Part> parts;
    if (!nodes_.empty()) parts.push_back(part(0));
    // Twice as many as are wanted: some are of little use.
    while (!parts.empty() && parts.size() < 2 * most && parts.front().urgency > 0) {
        std::ranges::pop_heap(parts, lessUrgent);
        const std::uint32_t left = nodes_[parts.back().node].left;
        parts.pop_back();
        for (const std::uint32_t child : {left, left + 1}) {
            parts.push_back(part(child));
            std::ranges::push_heap(parts, lessUrgent);
        }
    }
    std::ranges::sort(parts, [](const Part& a, const Part& b) {
        return std::pair(-a.irradiance, a.node) < std::pair(-b.irradiance, b.node);
    });
    std::vector<Ball> balls;
    for (const Part& p : parts)
        if (balls.size() < most && p.irradiance > 0) balls.push_back(nodes_[p.node].ball);
    return balls;
}

}  // namespace shadowcache
