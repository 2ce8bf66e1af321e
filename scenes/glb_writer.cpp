#include <Imath/ImathBox.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "common/base/error.h"
#include "common/mesh/smooth_normals.h"
#include "scenes/geometry.h"

namespace shadowcache::scenes {
namespace {

using nlohmann::json;

/// Largest angle between neighbouring triangles that are one smooth surface, in degrees.
constexpr double kCrease = 40;

struct Material {
    Finish finish;
    const char* name;
    double metallic;
    double roughness;
};

constexpr Material kMaterials[] = {
    {Finish::matte, "matte", 0, 1},
    {Finish::honed, "honed stone", 0, 0.45},
    {Finish::waxed, "waxed leaf", 0, 0.5},
    {Finish::varnished, "varnished wood", 0, 0.3},
    {Finish::glazed, "glazed clay", 0, 0.15},
    {Finish::bronze, "bronze", 1, 0.35},
    {Finish::gilded, "gilded", 1, 0.25},
    {Finish::water, "water", 0, 0.03},
    {Finish::pane, "pane", 0, 0},
    {Finish::lantern, "lantern", 0, 1},
};

/// Puts an extension into a part of the document, and its name into `used`.
void extend(json& part, const char* name, const json& value, std::set<std::string>& used) {
    part["extensions"][name] = value;
    used.insert(name);
}

json describe(const Material& material, std::set<std::string>& used) {
    json described{
        {"name", material.name},
        {"doubleSided", material.finish != Finish::lantern},  // shines to its outside alone
        {"pbrMetallicRoughness",
         {{"metallicFactor", material.metallic}, {"roughnessFactor", material.roughness}}}};
    const auto have = [&](const char* name, const json& value) {
        extend(described, name, value, used);
    };
    // glTF has no Lambertian surface but one that reflects nothing.
    if (material.finish == Finish::matte || material.finish == Finish::lantern)
        have("KHR_materials_specular", {{"specularFactor", 0}});
    if (material.finish == Finish::water) have("KHR_materials_ior", {{"ior", 1.33}});
    if (material.finish == Finish::pane)
        have("KHR_materials_transmission", {{"transmissionFactor", 1}});
    if (material.finish == Finish::lantern) {
        described["emissiveFactor"] = {1.0, 0.62, 0.3};
        have("KHR_materials_emissive_strength", {{"emissiveStrength", 40}});
    }
    return described;
}

/// A glTF file under construction: arrays go in, indices of accessors come out.
class Glb {
public:
    json document{{"asset", {{"version", "2.0"}, {"generator", "shadowcache-make-set"}}},
                  {"scene", 0},
                  {"scenes", {{{"nodes", {0}}}}},
                  {"nodes", {{{"mesh", 0}, {"name", "set"}}}},
                  {"meshes", {{{"primitives", json::array()}}}}};

    std::set<std::string> extensions;  ///< that the document uses

    /// @param values  three floats each
    template <class T>
    std::size_t accessor(const std::vector<T>& values) {
        static_assert(sizeof(T) == 3 * sizeof(float));
        const std::size_t bytes = values.size() * sizeof(T);
        document["bufferViews"].push_back(
            {{"buffer", 0}, {"byteOffset", data_.size()}, {"byteLength", bytes}});
        const auto* first = reinterpret_cast<const char*>(values.data());
        data_.insert(data_.end(), first, first + bytes);
        constexpr int kFloat = 5126;
        document["accessors"].push_back({{"bufferView", document["bufferViews"].size() - 1},
                                         {"componentType", kFloat},
                                         {"count", values.size()},
                                         {"type", "VEC3"}});
        return document["accessors"].size() - 1;
    }

    void write(const std::filesystem::path& path) {
        document["extensionsUsed"] = extensions;
        document["buffers"] = {{{"byteLength", data_.size()}}};
        std::string text = document.dump();
        text.resize((text.size() + 3) / 4 * 4, ' ');
        std::ofstream out(path, std::ios::binary);
        const auto put = [&](std::initializer_list<std::size_t> words) {
            for (const std::size_t w : words) {
                const auto word = static_cast<std::uint32_t>(w);
                out.write(reinterpret_cast<const char*>(&word), sizeof word);
            }
        };
        constexpr std::size_t kGltf = 0x46546c67, kJson = 0x4e4f534a, kBinary = 0x004e4942;
        put({kGltf, 2, 28 + text.size() + data_.size(), text.size(), kJson});
        out.write(text.data(), static_cast<std::streamsize>(text.size()));
        put({data_.size(), kBinary});
        out.write(data_.data(), static_cast<std::streamsize>(data_.size()));
        if (!out.flush()) throwFileError(path, "cannot be written");
    }

private:
    std::vector<char> data_;  ///< arrays of four-byte numbers
};

/// Triangles that share no vertex: the normal of a corner is its own.
void addPart(Glb& glb, const SetMesh& mesh, Finish finish, std::size_t material) {
    const SetPart part = partOf(mesh, [=](Finish f) { return f == finish; });
    if (part.triangles.empty()) return;
    TriangleMesh smooth;
    smooth.triangles = part.triangles;
    for (const std::size_t v : part.vertices) smooth.positions.push_back(mesh.positions[v]);
    smoothNormals(smooth, kCrease);

    std::vector<Vec3f> positions, normals;
    std::vector<Rgb> colors;
    Imath::Box3f bounds;
    for (std::size_t i = 0; i < part.triangles.size(); ++i) {
        const Vec3i& corners = part.triangles[i];
        const Vec3f* p = smooth.positions.data();
        const Vec3f flat =
            (p[corners.y] - p[corners.x]).cross(p[corners.z] - p[corners.x]).normalized();
        for (int k = 0; k < 3; ++k) {
            const auto v = static_cast<std::size_t>(corners[k]);
            const int normal = smooth.normals.empty() ? -1 : smooth.cornerNormals[i][k];
            positions.push_back(p[v]);
            bounds.extendBy(p[v]);
            normals.push_back(normal < 0 ? flat : smooth.normals[static_cast<std::size_t>(normal)]);
            colors.push_back(mesh.colors[part.vertices[v]]);
        }
    }
    const std::size_t places = glb.accessor(positions);
    const auto list = [](const Vec3f& v) { return json{v.x, v.y, v.z}; };
    glb.document["accessors"][places]["min"] = list(bounds.min);
    glb.document["accessors"][places]["max"] = list(bounds.max);
    glb.document["meshes"][0]["primitives"].push_back({{"attributes",
                                                        {{"POSITION", places},
                                                         {"NORMAL", glb.accessor(normals)},
                                                         {"COLOR_0", glb.accessor(colors)}}},
                                                       {"material", material}});
}

void addLamp(Glb& glb, const PointLamp& lamp) {
    if (!glb.document.contains("extensions"))
        extend(glb.document, "KHR_lights_punctual", {{"lights", json::array()}}, glb.extensions);
    json& lights = glb.document["extensions"]["KHR_lights_punctual"]["lights"];
    json node{
        {"name", lamp.name},
        {"translation", json{lamp.position.x, lamp.position.y, lamp.position.z}},
    };
    extend(node, "KHR_lights_punctual", {{"light", lights.size()}}, glb.extensions);
    lights.push_back({{"name", lamp.name},
                      {"type", "point"},
                      {"color", {lamp.color.x, lamp.color.y, lamp.color.z}},
                      {"intensity", lamp.intensity},
                      {"extras", {{"radius", lamp.radius}}}});
    glb.document["scenes"][0]["nodes"].push_back(glb.document["nodes"].size());
    glb.document["nodes"].push_back(node);
}

}  // namespace

void writeGlb(const std::filesystem::path& path, const SetMesh& mesh) {
    Glb glb;
    for (const Material& material : kMaterials) {
        glb.document["materials"].push_back(describe(material, glb.extensions));
        addPart(glb, mesh, material.finish, glb.document["materials"].size() - 1);
    }
    for (const PointLamp& lamp : mesh.lamps) addLamp(glb, lamp);
    glb.write(path);
}

}  // namespace shadowcache::scenes
