#pragma once

#include <string>
#include <vector>

#include "common/import/gltf_budget.h"
#include "common/import/gltf_pose.h"

namespace shadowcache {

/// The vertices of a primitive in the form that its mesh has: morph targets are added to their
/// attributes, and a skin places each of them.
class GltfVertices {
public:
    /// The references must live as long as this.
    ///
    /// @param place  where a mesh without skin stands
    /// @throws Error naming the file and the mesh: joints that do not fit, or as GltfBudget
    GltfVertices(const GltfDocument& document, const GltfShape& shape,
                 const GltfPrimitive& primitive, const Affine& place, GltfBudget& budget);

    /// An attribute's numbers; empty if the primitive has none.
    ///
    /// @param components  set to the numbers of a vertex where there are some
    /// @throws Error naming the file, the mesh and the attribute
    std::vector<double> attribute(const std::string& name, std::size_t& components) const;

    const GltfPrimitive& primitive() const { return primitive_; }
    /// @throws Error naming the file and the mesh
    [[noreturn]] void fail(const std::string& cause) const;

    /// Where a vertex is brought to.
    const Affine& place(std::size_t vertex) const {
        return places_.empty() ? place_ : places_[vertex];
    }
    /// Whether a triangle is turned inside out by the places of most of its corners.
    bool mirrors(std::size_t a, std::size_t b, std::size_t c) const;

private:
    void addTargets(const std::string& name, std::size_t components,
                    std::vector<double>& values) const;
    void placeBySkin();
    void takeBudget(GltfBudget& budget) const;
    std::vector<double> decoded(const std::string& name, int accessor) const;

    const GltfDocument& document_;
    const GltfShape& shape_;
    const GltfPrimitive& primitive_;
    Affine place_;
    std::vector<Affine> places_;  ///< by vertex; empty: all as place_
};

}  // namespace shadowcache
