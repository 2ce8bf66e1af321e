#include "common/import/gltf_vertices.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "common/base/error.h"

namespace shadowcache {

namespace {

/// Numbers of JOINTS_n and of WEIGHTS_n.
constexpr std::size_t kOfSet = 4;

/// What nothing was added to.
const Affine kNowhere{{Vec3d(0.0), Vec3d(0.0), Vec3d(0.0)}, Vec3d(0.0)};

void addScaled(Affine& sum, const Affine& term, double weight) {
    for (std::size_t k = 0; k < 3; ++k) sum.axis[k] += term.axis[k] * weight;
    sum.position += term.position * weight;
}

}  // namespace

GltfVertices::GltfVertices(const GltfDocument& document, const GltfShape& shape,
                           const GltfPrimitive& primitive, const Affine& place, GltfBudget& budget)
    : document_(document), shape_(shape), primitive_(primitive), place_(place) {
    takeBudget(budget);
    if (!shape.joints.empty()) placeBySkin();
}

void GltfVertices::fail(const std::string& cause) const {
    const std::string& name = document_.meshes[static_cast<std::size_t>(shape_.mesh)].name;
    throwFileError(document_.path,
                   fmt::format("mesh {}{}: {}", shape_.mesh,
                               name.empty() ? "" : fmt::format(" ({})", name), cause));
}

void GltfVertices::takeBudget(GltfBudget& budget) const {
    // The vertices, counted where the primitive says most, its corners, and what targets add.
    std::size_t vertices = 0;
    for (const auto& [name, index] : primitive_.attributes)
        vertices = std::max(vertices, document_.accessor(index).count);
    budget.take(vertices);
    budget.take(primitive_.indices >= 0 ? document_.accessor(primitive_.indices).count : vertices);
    const std::size_t targets = std::min(primitive_.targets.size(), shape_.weights.size());
    for (std::size_t i = 0; i < targets; ++i)
        if (shape_.weights[i] != 0) budget.take(vertices);
    if (!shape_.joints.empty()) budget.take(vertices);
}

std::vector<double> GltfVertices::decoded(const std::string& name, int accessor) const {
    std::string cause;
    std::vector<double> values = decode(document_.accessor(accessor), cause);
    if (!cause.empty()) fail(name + ": " + cause);
    return values;
}

std::vector<double> GltfVertices::attribute(const std::string& name,
                                            std::size_t& components) const {
    const auto found = primitive_.attributes.find(name);
    if (found == primitive_.attributes.end()) return {};
    components = document_.accessor(found->second).array.components;
    std::vector<double> values = decoded(name, found->second);
    addTargets(name, components, values);
    return values;
}

void GltfVertices::addTargets(const std::string& name, std::size_t components,
                              std::vector<double>& values) const {
    const std::size_t targets = std::min(primitive_.targets.size(), shape_.weights.size());
    for (std::size_t i = 0; i < targets; ++i) {
        const double weight = shape_.weights[i];
        const auto found = primitive_.targets[i].find(name);
        if (weight == 0 || found == primitive_.targets[i].end()) continue;
        const std::string owner = fmt::format("morph target {}, {}", i, name);
        const std::vector<double> more = decoded(owner, found->second);
        // A target adds to a tangent's direction and leaves its side.
        const std::size_t added = document_.accessor(found->second).array.components;
        const std::size_t wanted = name == "TANGENT" ? 3 : components;
        const std::size_t vertices = values.size() / components;
        if (added != wanted || more.size() != wanted * vertices)
            fail(fmt::format("{}: {} numbers, expected {} for each of {} vertices", owner,
                             more.size(), wanted, vertices));
        for (std::size_t v = 0; v < vertices; ++v)
            for (std::size_t k = 0; k < wanted; ++k)
                values[v * components + k] += weight * more[v * wanted + k];
    }
}

/// A vertex is where the mean of its joints' places puts it. [glTF 2.0, Sec. 3.7.3.3]
void GltfVertices::placeBySkin() {
    std::vector<double> sums;
    for (int set = 0;; ++set) {
        const std::string ending = std::to_string(set);
        const auto joints = primitive_.attributes.find("JOINTS_" + ending);
        const auto weights = primitive_.attributes.find("WEIGHTS_" + ending);
        if (joints == primitive_.attributes.end() || weights == primitive_.attributes.end()) break;
        std::string cause;
        const auto which = decodeIndices(document_.accessor(joints->second), cause);
        if (!cause.empty()) fail(joints->first + ": " + cause);
        const std::vector<double> share = decoded(weights->first, weights->second);
        if (set == 0) {
            sums.assign(which.size() / kOfSet, 0.0);
            places_.assign(sums.size(), kNowhere);
        }
        if (document_.accessor(joints->second).array.components != kOfSet ||
            which.size() != kOfSet * sums.size() || share.size() != which.size())
            fail(joints->first + " and " + weights->first +
                 " do not match, expected four numbers of each for each vertex");
        for (std::size_t i = 0; i < which.size(); ++i) {
            if (share[i] == 0) continue;
            if (which[i] >= shape_.joints.size())
                fail(fmt::format("{}: joint {}, expected 0 to {}", joints->first, which[i],
                                 shape_.joints.size() - 1));
            addScaled(places_[i / kOfSet], shape_.joints[which[i]], share[i]);
            sums[i / kOfSet] += share[i];
        }
    }
    const auto positions = primitive_.attributes.find("POSITION");
    if (sums.empty() || positions == primitive_.attributes.end() ||
        document_.accessor(positions->second).count != sums.size())
        fail("has a skin, expected JOINTS_0 and WEIGHTS_0 for each vertex");
    for (std::size_t v = 0; v < sums.size(); ++v) {
        if (!std::isfinite(sums[v])) fail("WEIGHTS_0 is not finite");
        // A vertex without weights follows the first joint, as in other viewers.
        if (sums[v] > 0) {
            Affine mean = kNowhere;
            addScaled(mean, places_[v], 1 / sums[v]);
            places_[v] = mean;
        } else {
            places_[v] = shape_.joints.front();
        }
    }
}

bool GltfVertices::mirrors(std::size_t a, std::size_t b, std::size_t c) const {
    if (places_.empty()) return place_.mirrors();
    int count = 0;
    for (const std::size_t v : {a, b, c}) count += v < places_.size() && places_[v].mirrors();
    return count > 1;
}

}  // namespace shadowcache
