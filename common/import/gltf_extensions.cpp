#include "common/import/gltf_extensions.h"

#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#include <tiny_gltf.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <set>
#include <string_view>

namespace shadowcache {

namespace {

/// Read of materials.
constexpr std::array<std::string_view, 5> kOfMaterials{
    "KHR_materials_emissive_strength", "KHR_materials_ior", "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_specular", "KHR_materials_unlit"};

/// Their materials are read without them, and the report says so.
constexpr std::array<std::string_view, 7> kLeftOutOfMaterials{
    "KHR_materials_anisotropy",  "KHR_materials_clearcoat", "KHR_materials_dispersion",
    "KHR_materials_iridescence", "KHR_materials_sheen",     "KHR_materials_transmission",
    "KHR_materials_volume"};

/// Read of anything else, or with nothing to be seen.
constexpr std::array<std::string_view, 9> kOfOthers{
    "EXT_mesh_gpu_instancing", "EXT_meshopt_compression",
    "EXT_texture_webp",        "KHR_draco_mesh_compression",
    "KHR_mesh_quantization",   "KHR_node_visibility",
    "KHR_texture_transform",   "KHR_xmp",
    "KHR_xmp_json_ld"};

/// Read in part, or not at all, of anything else; a file may require them all the same.
constexpr std::array<std::string_view, 2> kInPartOfOthers{"KHR_lights_punctual",
                                                          "KHR_materials_variants"};

template <std::size_t N>
bool has(const std::array<std::string_view, N>& names, const std::string& name) {
    return std::ranges::find(names, name) != names.end();
}

/// Of kinds and names; others are counted together.
constexpr std::size_t kMostNamed = 20;

constexpr const char* kLeftOut = " is left out";

/// A name from a file in one line of a terminal.
std::string printable(std::string name) {
    for (char& c : name)
        if (std::iscntrl(static_cast<unsigned char>(c))) c = '?';
    return name;
}

bool isMaterialName(const std::string& name) {
    return name.find("_materials_") != std::string::npos;
}

/// Counts by kind of thing.
class Counter {
public:
    explicit Counter(LeftOutOf& leftOut) : leftOut_(leftOut) {}

    void add(const std::string& kind, const tinygltf::ExtensionMap& extensions) {
        for (const auto& [name, value] : extensions) add(kind, name);
    }

    void add(const std::string& kind, const std::string& name) {
        if (has(kOfOthers, name)) return;
        counted_.insert(name);
        std::string shown = printable(name);
        if (leftOut_.size() >= kMostNamed && !leftOut_.contains({kind, shown + kLeftOut}))
            shown = "other extension";
        const char* what = name == "KHR_materials_variants"
                               ? " are left out but for the default material"
                               : kLeftOut;
        ++leftOut_[{kind, shown + what}];
    }

    bool counted(const std::string& name) const { return counted_.contains(name); }

private:
    LeftOutOf& leftOut_;
    std::set<std::string> counted_;
};

}  // namespace

bool mayRequireGltfExtension(const std::string& name) {
    return has(kOfMaterials, name) || has(kLeftOutOfMaterials, name) || has(kOfOthers, name) ||
           has(kInPartOfOthers, name);
}

bool isReadOfMaterials(const std::string& name) {
    return has(kOfMaterials, name);
}

void countLeftOut(const tinygltf::Model& model, const std::vector<bool>& inScene,
                  LeftOutOf& leftOut) {
    Counter counter(leftOut);
    std::set<int> meshes, cameras;
    for (std::size_t i = 0; i < model.nodes.size(); ++i) {
        if (!inScene[i]) continue;
        const tinygltf::Node& node = model.nodes[i];
        counter.add("node", node.extensions);
        if (node.mesh >= 0) meshes.insert(node.mesh);
        if (node.camera >= 0) cameras.insert(node.camera);
    }
    for (const int mesh : meshes) {
        const tinygltf::Mesh& m = model.meshes[static_cast<std::size_t>(mesh)];
        counter.add("mesh", m.extensions);
        for (const tinygltf::Primitive& p : m.primitives) counter.add("primitive", p.extensions);
    }
    for (const int camera : cameras)
        counter.add("camera", model.cameras[static_cast<std::size_t>(camera)].extensions);
    const auto scene = static_cast<std::size_t>(std::max(0, model.defaultScene));
    if (scene < model.scenes.size()) counter.add("scene", model.scenes[scene].extensions);
    // What other parts have, as animations and textures. Libraries of what nothing uses are no
    // loss.
    for (const std::string& name : model.extensionsUsed)
        if (!counter.counted(name) && !isMaterialName(name) && !has(kInPartOfOthers, name))
            counter.add("file", name);
}

}  // namespace shadowcache
