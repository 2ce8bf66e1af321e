#include "common/emitters/emitters.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "common/base/hash.h"
#include "common/mesh/placed_mesh.h"

namespace shadowcache {

namespace {

/// Parts of a leaf of the tree, at most.
constexpr std::uint32_t kLeaf = 8;

/// Least that neighbours may emit towards a place, as a share: what is between their normals.
constexpr float kLeastTowards = 0.05f;

/// Radius that counts for a point that is where it lights.
constexpr float kLeastRadius = 1e-9f;

constexpr double kBelowOne = 1 - 0x1p-53;

using Form = EmitterPart::Form;

std::uint64_t hashOf(const Vec3f& p) {
    const auto bits = [](float value) { return std::bit_cast<std::uint32_t>(value + 0.0f); };
    return hashWords(bits(p.x), bits(p.y), bits(p.z));
}

void extend(Box3d& box, const EmitterPart& part) {
    if (part.form == Form::triangle)
        for (const Vec3f& corner : part.corner) box.extendBy(Vec3d(corner));
    else
        box.extendBy(Vec3d(part.centre));
}

/// Whether a ray can meet a part that is no surface.
bool isLampToMeet(const EmitterPart& part) {
    return !part.isSurface() && part.hasExtent();
}

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

/// Distance of a part's farthest place from a place.
float farthest(const EmitterPart& part, const Vec3f& from) {
    if (part.form != Form::triangle) return (part.centre - from).length() + part.radius;
    float distance = 0;
    for (const Vec3f& corner : part.corner) distance = std::max(distance, (corner - from).length());
    return distance;
}

/// Numbers of the groups of parts that have corners in common and one owner.
std::vector<std::uint32_t> connect(std::span<const FoundPart> parts) {
    std::vector<std::uint32_t> parent(parts.size());
    std::iota(parent.begin(), parent.end(), 0u);
    const auto root = [&](std::uint32_t i) {
        while (parent[i] != i) i = parent[i] = parent[parent[i]];
        return i;
    };
    std::vector<std::pair<std::uint64_t, std::uint32_t>> corners;
    for (std::uint32_t i = 0; i < parts.size(); ++i)
        for (const Vec3f& corner : parts[i].part.corner)
            corners.emplace_back(hashWords(hashOf(corner), parts[i].owner), i);
    std::ranges::sort(corners);
    for (std::size_t i = 1; i < corners.size(); ++i)
        if (corners[i].first == corners[i - 1].first)
            parent[root(corners[i].second)] = root(corners[i - 1].second);
    for (std::uint32_t i = 0; i < parts.size(); ++i) parent[i] = root(i);
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
        std::vector<EmitterPart> parts{};
        Vec3f centre{0, 0, 0};

        Form form() const { return parts.front().form; }
    };
    Emitters& to;
    std::vector<std::uint32_t> groupsOfNode{};

    /// Those of one form are neighbours.
    static std::vector<Group> groupsOf(std::span<const FoundPart> parts) {
        const std::vector<std::uint32_t> number = connect(parts);
        std::vector<std::uint32_t> order(parts.size());
        std::iota(order.begin(), order.end(), 0u);
        std::ranges::stable_sort(
            order, {}, [&](std::uint32_t i) { return std::pair(parts[i].part.form, number[i]); });
        std::vector<Group> groups;
        for (std::size_t i = 0; i < order.size(); ++i) {
            if (i == 0 || number[order[i]] != number[order[i - 1]]) groups.emplace_back();
            groups.back().parts.push_back(parts[order[i]].part);
        }
        for (Group& group : groups) {
            Box3d box;
            for (const EmitterPart& part : group.parts) extend(box, part);
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

    /// Splits groups by their form, those of one form in the middle of where they are.
    static std::size_t divide(std::span<Group> groups) {
        const Form form = groups.front().form();
        const auto isOfForm = [form](const Group& group) { return group.form() == form; };
        const auto other = std::ranges::find_if_not(groups, isOfForm);
        if (other != groups.end()) return static_cast<std::size_t>(other - groups.begin());
        sortAlong(groups, [](const Group& g) { return g.centre; });
        return groups.size() / 2;
    }

    void build(std::uint32_t node, std::span<Group> groups) {
        if (groups.size() == 1) return build(node, std::span(groups.front().parts));
        const std::size_t half = divide(groups);
        const std::uint32_t left = addNodes(2);
        const auto begin = static_cast<std::uint32_t>(to.parts_.size());
        build(left, groups.first(half));
        build(left + 1, groups.subspan(half));
        to.nodes_[node] = to.summed(begin, static_cast<std::uint32_t>(to.parts_.size()));
        to.nodes_[node].left = left;
        groupsOfNode[node] = static_cast<std::uint32_t>(groups.size());
    }

    void build(std::uint32_t node, std::span<EmitterPart> parts) {
        const auto begin = static_cast<std::uint32_t>(to.parts_.size());
        std::uint32_t left = 0;
        if (parts.size() <= kLeaf) {
            to.parts_.insert(to.parts_.end(), parts.begin(), parts.end());
        } else {
            sortAlong(parts, [](const EmitterPart& t) { return t.centre; });
            left = addNodes(2);
            build(left, parts.first(parts.size() / 2));
            build(left + 1, parts.subspan(parts.size() / 2));
        }
        to.nodes_[node] = to.summed(begin, static_cast<std::uint32_t>(to.parts_.size()));
        to.nodes_[node].left = left;
    }
};

Emitters::Emitters(std::span<const TriangleMesh* const> meshes, EmitterWeight weight)
    : meshes_(meshes.begin(), meshes.end()) {
    const std::vector<FoundPart> found = findParts(meshes, weight);
    if (found.empty()) return;
    parts_.reserve(found.size());
    std::vector<Builder::Group> groups = Builder::groupsOf(found);
    Builder builder{*this};
    builder.build(builder.addNodes(1), std::span(groups));
    cut(builder.groupsOfNode);
    findShapes();
    indexPlaces();
    hasSeenLamps_ = std::ranges::any_of(parts_, &EmitterPart::seenByCamera);
}

Emitters::Node Emitters::summed(std::uint32_t begin, std::uint32_t end) const {
    Node node;
    node.begin = begin;
    node.end = end;
    node.form = parts_[begin].form;
    Box3d box;
    for (std::uint32_t i = begin; i < end; ++i) {
        const EmitterPart& t = parts_[i];
        extend(box, t);
        const float weight = t.weight * t.area;
        const Vec3f& n = t.normal;
        node.flux += t.radiance * t.area;
        node.weight += weight;
        node.isMixed = node.isMixed || t.form != node.form;
        node.hasCones = node.hasCones || t.cone.has_value();
        node.hasLamps = node.hasLamps || isLampToMeet(t);
        if (t.form != Form::triangle) continue;
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
    if (node.isMixed || node.form == Form::sun) {
        node.radius = std::numeric_limits<float>::infinity();
        return node;
    }
    for (std::uint32_t i = begin; i < end; ++i)
        node.radius = std::max(node.radius, farthest(parts_[i], node.centre));
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
    emitterOf_.resize(parts_.size());
    for (std::size_t e = 0; e < roots_.size(); ++e)
        for (std::uint32_t i = nodes_[roots_[e]].begin; i < nodes_[roots_[e]].end; ++i)
            emitterOf_[i] = static_cast<std::uint32_t>(e);
}

void Emitters::findShapes() {
    for (std::size_t e = 0; e < size(); ++e) {
        std::uint64_t hash = 0;  // a sum, so that the order does not matter
        for (const EmitterPart& t : partsOf(e)) {
            if (t.form == Form::triangle) {
                std::uint64_t corners = 0;
                for (const Vec3f& corner : t.corner) corners += hashOf(corner);
                hash += hashWords(corners, t.twoSided);
            } else {
                const Vec3f& place = t.form == Form::sun ? t.normal : t.centre;
                hash += hashWords(hashOf(place), hashOf({t.radius, t.sineSquared, 0}),
                                  static_cast<std::uint64_t>(t.form));
            }
        }
        shapes_.push_back(mixBits(hash));
    }
}

void Emitters::indexPlaces() {
    for (std::uint32_t i = 0; i < parts_.size(); ++i) {
        const EmitterPart& t = parts_[i];
        if (t.isSurface()) byPlace_.emplace_back(std::uint64_t{t.mesh} << 32 | t.placed, i);
    }
    std::ranges::sort(byPlace_);
}

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

Rgb Emitters::radianceAt(const EmitterPart& t, const EmitterPoint& point) const noexcept {
    if (!t.varies) return t.radiance * point.share;
    const TriangleMesh& mesh = *meshes_[t.mesh];
    return emittedAt(mesh, placedTriangle(mesh, t.placed).triangle, point.u, point.v);
}

/// Weight times area that is turned towards a direction. Points turn theirs. That of both sides is
/// about the root of the mean square, which is right for what is flat; of one side it is the mean
/// of both sides' and of the sum of the normals.
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
    if (node.end > node.begin + 1 && !node.hasCones &&
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

/// What some parts may be worth to a place: above 0 wherever they are worth something.
float Emitters::boundOf(const Node& node, const Receiver& at) noexcept {
    if (node.form == Form::sun) return node.weight;
    const Vec3f way = node.centre - at.position;
    const float squared = way.length2(), height = at.normal.dot(way) + node.radius;
    if (height <= 0 || !(node.weight > 0)) return 0;
    const float distance = std::sqrt(squared);
    if (distance <= node.radius || !(squared > 0)) {
        const float radius = std::max(node.radius, kLeastRadius);
        return node.weight / (radius * radius);
    }
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
        sum += weights[i] = irradianceBy(parts_[node->begin + i], at).weight;
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
        if (!isLampToMeet(parts_[i])) continue;
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
