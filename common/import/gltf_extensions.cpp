#include "common/import/gltf_extensions.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

namespace shadowcache {

namespace {

/// Read of materials.
constexpr std::array<std::string_view, 6> kOfMaterials{
    "KHR_materials_emissive_strength",     "KHR_materials_ior",
    "KHR_materials_pbrSpecularGlossiness", "KHR_materials_specular",
    "KHR_materials_transmission",          "KHR_materials_unlit"};

/// Their materials are read without them, and the report says so.
constexpr std::array<std::string_view, 6> kLeftOutOfMaterials{
    "KHR_materials_anisotropy",  "KHR_materials_clearcoat", "KHR_materials_dispersion",
    "KHR_materials_iridescence", "KHR_materials_sheen",     "KHR_materials_volume"};

/// Read of anything else, or with nothing to be seen.
constexpr std::array<std::string_view, 10> kOfOthers{"EXT_mesh_gpu_instancing",
                                                     "EXT_meshopt_compression",
                                                     "EXT_texture_webp",
                                                     "KHR_draco_mesh_compression",
                                                     "KHR_lights_punctual",
                                                     "KHR_mesh_quantization",
                                                     "KHR_node_visibility",
                                                     "KHR_texture_transform",
                                                     "KHR_xmp",
                                                     "KHR_xmp_json_ld"};

/// Read in part, or not at all, of anything else; a file may require them all the same.
constexpr std::array<std::string_view, 1> kInPartOfOthers{"KHR_materials_variants"};

template <std::size_t N>
bool has(const std::array<std::string_view, N>& names, const std::string& name) {
    return std::ranges::find(names, name) != names.end();
}

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

}  // namespace

bool mayRequireGltfExtension(const std::string& name) {
    return has(kOfMaterials, name) || has(kLeftOutOfMaterials, name) || has(kOfOthers, name) ||
           has(kInPartOfOthers, name);
}

bool isReadOfMaterials(const std::string& name) {
    return has(kOfMaterials, name);
}

void ExtensionCounter::addName(const std::string& kind, const std::string& name) {
    if (has(kOfOthers, name)) return;
    counted_.insert(name);
    count(
        kind, name, "other extension",
        name == "KHR_materials_variants" ? " are left out but for the default material" : kLeftOut);
}

void ExtensionCounter::addAttribute(const std::string& kind, const std::string& name) {
    count(kind, "attribute " + name, "other attribute", kLeftOut);
}

void ExtensionCounter::count(const std::string& kind, const std::string& name,
                             const std::string& other, const char* what) {
    const std::string shown = printable(name) + what;
    const bool isTold = leftOut_.size() < kMostNamed || leftOut_.contains({kind, shown});
    ++leftOut_[{kind, isTold ? shown : other + what}];
}

void ExtensionCounter::add(const std::string& kind, const GltfObject& thing) {
    for (const std::string& name : thing.object("extensions").keys()) addName(kind, name);
}

void ExtensionCounter::addOthers(const GltfObject& root) {
    std::set<std::string> names = root.extensionNames();
    for (const std::string& name : root.texts("extensionsUsed")) names.insert(name);
    for (const std::string& name : names)
        if (!counted_.contains(name) && !isMaterialName(name) && !has(kInPartOfOthers, name))
            addName("file", name);
}

}  // namespace shadowcache
