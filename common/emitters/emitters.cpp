#include "common/emitters/emitters.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <optional>

#include "common/base/hash.h"
#include "common/emitters/lit_triangle.h"
#include "common/mesh/looks.h"
#include "common/mesh/placed_mesh.h"

namespace shadowcache {

namespace {

/// Triangles of a leaf of the tree, at most.
constexpr std::uint32_t kLeaf = 8;

/// Distance in radii from which on a triangle, or some, count as their centre: off by 2 per cent.
constexpr float kFar = 8;

/// Distance in longest sides up to which points of a triangle are drawn in solid angle: farther
/// away, area does as well.
constexpr float kNear = 3;

/// Points of a triangle whose mean radiance is that of the triangle.
constexpr int kMeanPoints = 32;

/// Of a triangle that varies, weight of what its brightest point may emit: no point is missed.
constexpr float kLeastBrightness = 0.05f;

/// Least that neighbours may emit towards a place, as a share: what is between their normals.
constexpr float kLeastTowards = 0.05f;

constexpr double kBelowOne = 1 - 0x1p-53;

float brightness(const Rgb& c) {
    return std::max(0.0f, luminance(c));
}

Rgb emittedAt(const TriangleMesh& mesh, std::uint32_t triangle, float u, float v) {
    const Rgb emission = surfaceAt(mesh, triangle, u, v, {}).emission;
    const Material& material = *materialOf(mesh, triangle);
    return emission * opacityAt(mesh, material, triangle, u, v);
}

/// Whether a material emits, and the most that a point of it may.
Rgb mostEmitted(const Material& material) {
    return material.finish.unlit ? material.albedo : material.finish.emission;
}

bool isPlain(const TriangleMesh& mesh, const Material& material) {
    if (material.cutOut || material.blends) return false;
    if (material.finish.unlit) return material.texture < 0 && mesh.colors.empty();
    return material.finish.emissionTexture.texture < 0;
}

/// The triangle as it emits; without area if it does not.
EmissiveTriangle emissive(const TriangleMesh& mesh, std::uint32_t placed,
                          const Material& material) {
    const std::array<Vec3d, 3> corners = placedCorners(mesh, placed);
    EmissiveTriangle t;
    for (std::size_t k = 0; k < 3; ++k) {
        t.corner[k] = Vec3f(corners[k]);
        t.size = std::max(t.size, static_cast<float>((corners[(k + 1) % 3] - corners[k]).length()));
    }
    const Vec3d across = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    t.area = static_cast<float>(0.5 * across.length());
    if (!(t.area > 0)) return t;
    const Vec3d centre = (corners[0] + corners[1] + corners[2]) / 3;
    t.centre = Vec3f(centre);
    for (const Vec3d& corner : corners)
        t.radius = std::max(t.radius, static_cast<float>((corner - centre).length()));
    t.normal = placedNormal(mesh, placed, corners);
    t.placed = placed;
    t.twoSided = material.doubleSided;
    t.varies = !isPlain(mesh, material);
    const std::uint32_t triangle = placedTriangle(mesh, placed).triangle;
    if (!t.varies) {
        t.radiance = emittedAt(mesh, triangle, 0, 0);
        t.weight = brightness(t.radiance);
        return t;
    }
    for (int i = 0; i < kMeanPoints; ++i) {
        // A lattice of the unit square, folded to the triangle.
        float u = (static_cast<float>(i) + 0.5f) / kMeanPoints;
        float v = std::fmod(static_cast<float>(i) * 0.6180339887f + 0.5f, 1.0f);
        if (u + v > 1) u = 1 - u, v = 1 - v;
        t.radiance += emittedAt(mesh, triangle, u, v) * (1.0f / kMeanPoints);
    }
    t.weight = brightness(t.radiance) + kLeastBrightness * brightness(mostEmitted(material));
    return t;
}

std::uint64_t hashOf(const Vec3f& p) {
    const auto bits = [](float value) { return std::bit_cast<std::uint32_t>(value + 0.0f); };
    return hashWords(bits(p.x), bits(p.y), bits(p.z));
}

/// Numbers of the groups of triangles that have corners in common and one material.
std::vector<std::uint32_t> connect(std::span<const EmissiveTriangle> triangles,
                                   std::span<const std::uint64_t> materials) {
    std::vector<std::uint32_t> parent(triangles.size());
    std::iota(parent.begin(), parent.end(), 0u);
    const auto root = [&](std::uint32_t i) {
        while (parent[i] != i) i = parent[i] = parent[parent[i]];
        return i;
    };
    std::vector<std::pair<std::uint64_t, std::uint32_t>> corners;
    for (std::uint32_t i = 0; i < triangles.size(); ++i)
        for (const Vec3f& corner : triangles[i].corner)
            corners.emplace_back(hashWords(hashOf(corner), materials[i]), i);
    std::ranges::sort(corners);
    for (std::size_t i = 1; i < corners.size(); ++i)
        if (corners[i].first == corners[i - 1].first)
            parent[root(corners[i].second)] = root(corners[i - 1].second);
    for (std::uint32_t i = 0; i < triangles.size(); ++i) parent[i] = root(i);
    return parent;
}

/// Sorts things by the coordinate along which their centres lie farthest apart.
template <class T, class Centre>
void sortAlong(std::span<T> things, const Centre& centreOf) {
    Box3d box;
    for (const T& thing : things) box.extendBy(Vec3d(centreOf(thing)));
    const auto axis = static_cast<int>(box.majorAxis());
    std::ranges::stable_sort(things, {}, [&](const T& thing) { return centreOf(thing)[axis]; });
}

}  // namespace

/// Makes the tree from the groups down.
struct Emitters::Builder {
    struct Group {
        std::vector<EmissiveTriangle> triangles;
        Vec3f centre;
    };
    Emitters& to;
    std::vector<std::uint32_t> groupsOfNode{};

    static std::vector<Group> groupsOf(std::span<const EmissiveTriangle> triangles,
                                       std::span<const std::uint64_t> materials) {
        const std::vector<std::uint32_t> number = connect(triangles, materials);
        std::vector<std::uint32_t> order(triangles.size());
        std::iota(order.begin(), order.end(), 0u);
        std::ranges::stable_sort(order, {}, [&](std::uint32_t i) { return number[i]; });
        std::vector<Group> groups;
        for (std::size_t i = 0; i < order.size(); ++i) {
            if (i == 0 || number[order[i]] != number[order[i - 1]]) groups.emplace_back();
            groups.back().triangles.push_back(triangles[order[i]]);
        }
        for (Group& group : groups) {
            Box3d box;
            for (const EmissiveTriangle& t : group.triangles)
                for (const Vec3f& corner : t.corner) box.extendBy(Vec3d(corner));
            group.centre = Vec3f(box.center());
        }
        return groups;
    }

    std::uint32_t addNodes(std::size_t count) {
        const auto first = static_cast<std::uint32_t>(to.nodes_.size());
        to.nodes_.resize(first + count);
        groupsOfNode.resize(first + count, 1);
        return first;
    }

    void build(std::uint32_t node, std::span<Group> groups) {
        if (groups.size() == 1) return build(node, std::span(groups.front().triangles));
        sortAlong(groups, [](const Group& g) { return g.centre; });
        const std::uint32_t left = addNodes(2);
        const auto begin = static_cast<std::uint32_t>(to.triangles_.size());
        build(left, groups.first(groups.size() / 2));
        build(left + 1, groups.subspan(groups.size() / 2));
        to.nodes_[node] = to.summed(begin, static_cast<std::uint32_t>(to.triangles_.size()));
        to.nodes_[node].left = left;
        groupsOfNode[node] = static_cast<std::uint32_t>(groups.size());
    }

    void build(std::uint32_t node, std::span<EmissiveTriangle> triangles) {
        const auto begin = static_cast<std::uint32_t>(to.triangles_.size());
        std::uint32_t left = 0;
        if (triangles.size() <= kLeaf) {
            to.triangles_.insert(to.triangles_.end(), triangles.begin(), triangles.end());
        } else {
            sortAlong(triangles, [](const EmissiveTriangle& t) { return t.centre; });
            left = addNodes(2);
            build(left, triangles.first(triangles.size() / 2));
            build(left + 1, triangles.subspan(triangles.size() / 2));
        }
        to.nodes_[node] = to.summed(begin, static_cast<std::uint32_t>(to.triangles_.size()));
        to.nodes_[node].left = left;
    }
};

Emitters::Emitters(std::span<const TriangleMesh* const> meshes, Weigh weigh)
    : meshes_(meshes.begin(), meshes.end()) {
    std::vector<EmissiveTriangle> found;
    std::vector<std::uint64_t> materials;
    for (std::uint32_t m = 0; m < meshes_.size(); ++m) {
        const TriangleMesh& mesh = *meshes_[m];
        if (std::ranges::none_of(mesh.materials, [](const Material& material) {
                return brightness(mostEmitted(material)) > 0;
            }))
            continue;
        const auto count = static_cast<std::uint32_t>(placedCount(mesh));
        for (std::uint32_t i = 0; i < count; ++i) {
            const Material* material = materialOf(mesh, placedTriangle(mesh, i).triangle);
            if (!material || !(brightness(mostEmitted(*material)) > 0)) continue;
            EmissiveTriangle t = emissive(mesh, i, *material);
            if (!(t.area > 0)) continue;
            t.mesh = m;
            if (weigh == Weigh::shape) t.weight = 1;
            found.push_back(t);
            materials.push_back(
                hashWords(m, static_cast<std::uint64_t>(material - mesh.materials.data())));
        }
    }
    if (found.empty()) return;
    triangles_.reserve(found.size());
    std::vector<Builder::Group> groups = Builder::groupsOf(found, materials);
    Builder builder{*this};
    builder.build(builder.addNodes(1), std::span(groups));
    cut(builder.groupsOfNode);
    findShapes();
    indexPlaces();
}

Emitters::Node Emitters::summed(std::uint32_t begin, std::uint32_t end) const {
    Node node;
    node.begin = begin;
    node.end = end;
    Box3d box;
    for (std::uint32_t i = begin; i < end; ++i) {
        const EmissiveTriangle& t = triangles_[i];
        for (const Vec3f& corner : t.corner) box.extendBy(Vec3d(corner));
        const float weight = t.weight * t.area;
        const Vec3f& n = t.normal;
        node.flux += t.radiance * t.area;
        node.weight += weight;
        if (t.twoSided)
            node.twoSidedShare += weight;
        else
            node.facing += n * weight;
        const float products[6] = {n.x * n.x, n.y * n.y, n.z * n.z,
                                   n.x * n.y, n.y * n.z, n.z * n.x};
        for (std::size_t k = 0; k < 6; ++k) node.spread[k] += products[k] * weight;
    }
    if (node.weight > 0) node.twoSidedShare /= node.weight;
    node.centre = Vec3f(box.center());
    for (std::uint32_t i = begin; i < end; ++i)
        for (const Vec3f& corner : triangles_[i].corner)
            node.radius = std::max(node.radius, (corner - node.centre).length());
    return node;
}

/// The emitters: the roots of as many subtrees as there may be, the largest divided first.
void Emitters::cut(const std::vector<std::uint32_t>& groupsOfNode) {
    roots_ = {0};
    const auto extent = [&](std::uint32_t node) {
        return groupsOfNode[node] > 1 ? nodes_[node].radius * nodes_[node].radius : -1.0f;
    };
    while (roots_.size() < kMostEmitters) {
        const auto largest = std::ranges::max_element(roots_, {}, extent);
        if (extent(*largest) < 0) break;
        const std::uint32_t left = nodes_[*largest].left;
        *largest = left;
        roots_.push_back(left + 1);
    }
    std::ranges::sort(roots_, {}, [&](std::uint32_t node) { return nodes_[node].begin; });
    emitterOf_.resize(triangles_.size());
    for (std::size_t e = 0; e < roots_.size(); ++e)
        for (std::uint32_t i = nodes_[roots_[e]].begin; i < nodes_[roots_[e]].end; ++i)
            emitterOf_[i] = static_cast<std::uint32_t>(e);
}

void Emitters::findShapes() {
    for (std::size_t e = 0; e < size(); ++e) {
        std::uint64_t hash = 0;  // a sum, so that the order does not matter
        for (const EmissiveTriangle& t : trianglesOf(e)) {
            std::uint64_t corners = 0;
            for (const Vec3f& corner : t.corner) corners += hashOf(corner);
            hash += hashWords(corners, t.twoSided);
        }
        shapes_.push_back(mixBits(hash));
    }
}

void Emitters::indexPlaces() {
    byPlace_.reserve(triangles_.size());
    for (std::uint32_t i = 0; i < triangles_.size(); ++i)
        byPlace_.emplace_back(std::uint64_t{triangles_[i].mesh} << 32 | triangles_[i].placed, i);
    std::ranges::sort(byPlace_);
}

std::span<const EmissiveTriangle> Emitters::trianglesOf(std::size_t emitter) const {
    const Node& root = nodes_[roots_[emitter]];
    return std::span(triangles_).subspan(root.begin, root.end - root.begin);
}

std::ptrdiff_t Emitters::find(std::uint32_t mesh, std::uint32_t placed) const {
    const std::pair<std::uint64_t, std::uint32_t> wanted{std::uint64_t{mesh} << 32 | placed, 0};
    const auto at = std::ranges::lower_bound(byPlace_, wanted);
    if (at == byPlace_.end() || at->first != wanted.first) return -1;
    return static_cast<std::ptrdiff_t>(at->second);
}

Rgb Emitters::radianceAt(const EmissiveTriangle& t, float u, float v) const noexcept {
    if (!t.varies) return t.radiance;
    const TriangleMesh& mesh = *meshes_[t.mesh];
    return emittedAt(mesh, placedTriangle(mesh, t.placed).triangle, u, v);
}

/// Weight times area that is turned towards a direction. That of both sides is about the root of
/// the mean square, which is right for what is flat; of one side it is the mean of both sides' and
/// of the sum of the normals.
float Emitters::Node::towards(const Vec3f& w) const noexcept {
    const float square =
        spread[0] * w.x * w.x + spread[1] * w.y * w.y + spread[2] * w.z * w.z +
        2 * (spread[3] * w.x * w.y + spread[4] * w.y * w.z + spread[5] * w.z * w.x);
    const float both = std::sqrt(std::max(0.0f, square * weight));
    const float oneSided = 0.5f * ((1 - twoSidedShare) * both + facing.dot(w));
    return twoSidedShare * both + std::max(0.0f, oneSided);
}

Unoccluded irradianceBy(const EmissiveTriangle& t, const Receiver& at) noexcept {
    const Vec3f way = t.centre - at.position;
    const float front = -t.normal.dot(way);
    if (front == 0 || (front < 0 && !t.twoSided)) return {};
    const float height = at.normal.dot(way), squared = way.length2();
    float integral = 0;
    if (squared > kFar * kFar * t.radius * t.radius && std::abs(height) > t.radius) {
        if (height < 0) return {};
        integral = t.area * (height / squared) * (std::abs(front) / squared);
    } else {
        const Vec3d place(at.position), n(at.normal);
        const LitPolygon polygon = aboveHorizon(
            {Vec3d(t.corner[0]) - place, Vec3d(t.corner[1]) - place, Vec3d(t.corner[2]) - place},
            n);
        if (polygon.corners == 0) return {};
        // However thin the part above the horizon is, a sample may meet it.
        integral = static_cast<float>(std::max(cosineIntegral(polygon, n), 1e-12));
    }
    return {t.radiance * integral, t.weight * integral};
}

Unoccluded Emitters::irradianceOf(const Node& node, const Receiver& at) const noexcept {
    const Vec3f way = node.centre - at.position;
    const float squared = way.length2(), height = at.normal.dot(way);
    if (node.end > node.begin + 1 && squared > kFar * kFar * node.radius * node.radius &&
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
        for (std::uint32_t i = node.begin; i < node.end; ++i) add(irradianceBy(triangles_[i], at));
    }
    return sum;
}

Unoccluded Emitters::irradiance(std::size_t emitter, const Receiver& at) const noexcept {
    return irradianceOf(nodes_[roots_[emitter]], at);
}

/// What some triangles may be worth to a place: above 0 wherever they are worth something.
float Emitters::boundOf(const Node& node, const Receiver& at) noexcept {
    const Vec3f way = node.centre - at.position;
    const float squared = way.length2(), height = at.normal.dot(way) + node.radius;
    if (height <= 0 || !(node.weight > 0)) return 0;
    const float distance = std::sqrt(squared);
    if (distance <= node.radius) return node.weight / (node.radius * node.radius);
    const float turned = std::max(node.towards(way * (-1 / distance)), kLeastTowards * node.weight);
    return turned * std::min(1.0f, height / distance) / squared;
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
        sum += weights[i] = irradianceBy(triangles_[node->begin + i], at).weight;
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

float Emitters::chanceOf(std::size_t triangle, const Receiver& at) const noexcept {
    const auto goLeft = [triangle](const Node& left, float) {
        return triangle >= left.begin && triangle < left.end;
    };
    const auto pick = [triangle](std::uint32_t first, std::span<const float>, float) {
        return static_cast<std::uint32_t>(triangle) - first;
    };
    return walk(emitterOf_[triangle], at, goLeft, pick).chance;
}

namespace {

bool isNear(const EmissiveTriangle& t, const Receiver& at) noexcept {
    return (t.centre - at.position).length2() < kNear * kNear * t.size * t.size;
}

std::array<Vec3d, 3> seenFrom(const EmissiveTriangle& t, const Vec3d& place) {
    return {Vec3d(t.corner[0]) - place, Vec3d(t.corner[1]) - place, Vec3d(t.corner[2]) - place};
}

/// Density of points drawn in area, as seen from a place.
float densityByArea(const EmissiveTriangle& t, const Vec3f& way) noexcept {
    const float squared = way.length2(), front = std::abs(t.normal.dot(way));
    return front > 0 ? squared * std::sqrt(squared) / (front * t.area) : 0.0f;
}

}  // namespace

EmitterPoint samplePoint(const EmissiveTriangle& t, const Receiver& at, double u,
                         double v) noexcept {
    EmitterPoint point;
    const float front = -t.normal.dot(t.centre - at.position);
    if (front == 0 || (front < 0 && !t.twoSided)) return point;
    const Vec3d place(at.position);
    const std::array<Vec3d, 3> corner = seenFrom(t, place);
    const Vec3d side1 = corner[1] - corner[0], side2 = corner[2] - corner[0];
    Vec3d way(0);
    double along1 = 0, along2 = 0;
    std::optional<LitPolygonSampler> near;
    if (isNear(t, at)) near.emplace(aboveHorizon(corner, Vec3d(at.normal)));
    if (near && near->solidAngle() > 0) {
        const Vec3d direction = near->sample(u, v), normal = side1.cross(side2);
        way = direction * (normal.dot(corner[0]) / normal.dot(direction));
        const Vec3d within = way - corner[0];
        along1 = normal.dot(within.cross(side2)) / normal.length2();
        along2 = normal.dot(side1.cross(within)) / normal.length2();
        point.density = static_cast<float>(1 / near->solidAngle());
        if (!(normal.dot(direction) != 0)) return {};
    } else {
        // Uniform over the triangle.
        const double root = std::sqrt(u);
        along1 = root * (1 - v);
        along2 = root * v;
        way = corner[0] + side1 * along1 + side2 * along2;
        point.density = densityByArea(t, Vec3f(way));
    }
    along1 = std::clamp(along1, 0.0, 1.0);
    along2 = std::clamp(along2, 0.0, 1 - along1);
    point.u = static_cast<float>(along1);
    point.v = static_cast<float>(along2);
    point.position = Vec3f(place + way);
    point.direction = Vec3f(way.normalized());
    return point;
}

float densityAt(const EmissiveTriangle& t, const Receiver& at, const Vec3f& position) noexcept {
    if (isNear(t, at)) {
        const LitPolygonSampler near(
            aboveHorizon(seenFrom(t, Vec3d(at.position)), Vec3d(at.normal)));
        if (near.solidAngle() > 0) return static_cast<float>(1 / near.solidAngle());
    }
    return densityByArea(t, position - at.position);
}

}  // namespace shadowcache
