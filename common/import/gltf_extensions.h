#pragma once

#include <cstddef>
#include <set>
#include <string>

#include "common/import/gltf_object.h"
#include "common/mesh/mesh.h"

namespace shadowcache {

/// Whether a file that requires the extension is read: all of it, or, of a material, without it,
/// which the report then says.
bool mayRequireGltfExtension(const std::string& name);

/// Whether what the extension says of a material is read.
bool isReadOfMaterials(const std::string& name);

/// Kinds and names that are told; others are counted together.
inline constexpr std::size_t kMostNamed = 20;

/// Counts, by kind of thing, the extensions that are left out.
class ExtensionCounter {
public:
    /// @param leftOut  outlives this
    explicit ExtensionCounter(LeftOutOf& leftOut) : leftOut_(leftOut) {}

    /// Those of a thing that the set uses.
    void add(const std::string& kind, const GltfObject& thing);
    /// The file's other ones, of animations and textures, whether it lists them or not. Libraries
    /// of what nothing uses are no loss.
    void addOthers(const GltfObject& root);

    /// Vertex or instance attributes that are not read.
    void addAttribute(const std::string& kind, const std::string& name);

private:
    void addName(const std::string& kind, const std::string& name);
    void count(const std::string& kind, const std::string& name, const std::string& other,
               const char* what);

    LeftOutOf& leftOut_;
    std::set<std::string> counted_;
};

}  // namespace shadowcache
