// How the tree of emitters is made.

#include <algorithm>
#include <bit>
#include <limits>
#include <numeric>
#include <utility>

#include "common/base/hash.h"
#include "common/emitters/emitters.h"

namespace shadowcache {

namespace {

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
    FoundParts all = findParts(meshes, weight);
    tables_ = std::move(all.tables);
    std::vector<FoundPart>& found = all.parts;
    const auto moving = std::stable_partition(
        found.begin(), found.end(), [](const FoundPart& part) { return !part.part.moves; });
    parts_.reserve(found.size());
    Builder builder{*this};
    for (const auto& some : {std::span<const FoundPart>(found.begin(), moving),
                             std::span<const FoundPart>(moving, found.end())}) {
        if (some.empty()) continue;
        std::vector<Builder::Group> groups = Builder::groupsOf(some);
        const std::uint32_t root = builder.addNodes(1);
        builder.build(root, std::span(groups));
        cut(root, builder.groupsOfNode);
    }
    findShapes();
    indexPlaces();
    hasSeenLamps_ = std::ranges::any_of(parts_, &EmitterPart::seenByCamera);
}

Emitters::Node Emitters::summed(std::uint32_t begin, std::uint32_t end) const {
    Node node;
    node.begin = begin;
    node.end = end;
    const EmitterPart& first = parts_[begin];
    node.form = first.form;
    node.hasSlats = first.slats > 0;
    Box3d box;
    for (std::uint32_t i = begin; i < end; ++i) {
        const EmitterPart& t = parts_[i];
        extend(box, t);
        const float weight = t.weight * t.area;
        const Vec3f& n = t.normal;
        node.flux += t.radiance * t.area;
        node.weight += weight;
        node.isMixed = node.isMixed || t.form != node.form;
        node.hasCones = node.hasCones || t.cone.has_value() || t.slats > 0;
        node.hasSlats =
            node.hasSlats && t.slats > 0 && t.mesh == first.mesh && t.lamp == first.lamp;
        node.hasLamps = node.hasLamps || t.isLampToMeet();
        if (t.form != Form::triangle) continue;
        if (t.twoSided)
            node.twoSidedShare += weight;
        else
            node.facing += n * weight;
        const float products[6] = {n.x * n.x, n.y * n.y, n.z * n.z,
                                   n.x * n.y, n.y * n.z, n.z * n.x};
        for (std::size_t k = 0; k < 6; ++k) node.spread[k] += products[k] * weight;
    }
    if (node.hasSlats) node.hasCones = false;
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

/// Adds the emitters of a tree: the roots of as many subtrees as there may be, the largest divided
/// first.
void Emitters::cut(std::uint32_t root, const std::vector<std::uint32_t>& groupsOfNode) {
    std::vector<std::uint32_t> roots{root};
    const auto extent = [&](std::uint32_t node) {
        return groupsOfNode[node] > 1 ? nodes_[node].radius * nodes_[node].radius : -1.0f;
    };
    while (roots.size() < kMostEmitters) {
        const auto largest = std::ranges::max_element(roots, {}, extent);
        if (extent(*largest) < 0) break;
        const std::uint32_t left = nodes_[*largest].left;
        *largest = left;
        roots.push_back(left + 1);
    }
    std::ranges::sort(roots, {}, [&](std::uint32_t node) { return nodes_[node].begin; });
    emitterOf_.resize(parts_.size());
    const std::size_t first = roots_.size();
    roots_.insert(roots_.end(), roots.begin(), roots.end());
    for (std::size_t e = first; e < roots_.size(); ++e)
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
                // Where a lamp does not shine, nothing is counted.
                if (!t.isSurface()) corners += hashOf(t.normal) + hashOf({t.slats, 0, 0});
                hash += hashWords(corners, t.twoSided);
            } else {
                const Vec3f& place = t.form == Form::sun ? t.normal : t.centre;
                hash += hashWords(hashOf(place), hashOf({t.radius, t.sineSquared, 0}),
                                  static_cast<std::uint64_t>(t.form));
                if (t.cone)
                    hash += hashOf(t.normal) + hashOf({static_cast<float>(t.cone->cosOuter), 0, 0});
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

}  // namespace shadowcache
