#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/mesh_files.h"

namespace shadowcache::test {

/// A glTF file under construction: arrays go in, indices of accessors come out; everything else is
/// plain JSON.
class GltfBuilder {
public:
    nlohmann::json json{{"asset", {{"version", "2.0"}}},
                        {"scene", 0},
                        {"scenes", {{{"nodes", nlohmann::json::array()}}}}};

    int view(const std::string& bytes, int stride = 0) {
        while (data_.size() % 4 != 0) data_ += '\0';
        nlohmann::json view{
            {"buffer", 0}, {"byteOffset", data_.size()}, {"byteLength", bytes.size()}};
        if (stride > 0) view["byteStride"] = stride;
        data_ += bytes;
        return append("bufferViews", view);
    }

    template <class T>
    int accessor(const std::vector<T>& values, const char* type, std::size_t components) {
        std::string bytes;
        for (const T value : values) bytes += bytesOf(value);
        return append("accessors", {{"bufferView", view(bytes)},
                                    {"componentType", typeOf(T())},
                                    {"count", values.size() / components},
                                    {"type", type}});
    }
    int scalars(const std::vector<float>& values) { return accessor(values, "SCALAR", 1); }
    int vectors(const std::vector<float>& values) { return accessor(values, "VEC3", 3); }

    int append(const char* list, const nlohmann::json& value) {
        json[list].push_back(value);
        return static_cast<int>(json[list].size()) - 1;
    }

    /// A mesh of one primitive.
    int mesh(const nlohmann::json& primitive) {
        return append("meshes", {{"primitives", {primitive}}});
    }

    /// A node at the scene's root.
    int root(const nlohmann::json& node) {
        const int index = append("nodes", node);
        json["scenes"][0]["nodes"].push_back(index);
        return index;
    }

    /// Animates a node's "translation", "rotation", "scale" or "weights".
    void animate(int node, const char* path, const char* interpolation,
                 const std::vector<float>& times, const std::vector<float>& values) {
        const int input = scalars(times);
        const int output = std::string(path) == "weights"    ? scalars(values)
                           : std::string(path) == "rotation" ? accessor(values, "VEC4", 4)
                                                             : vectors(values);
        append("animations",
               {{"channels", {{{"sampler", 0}, {"target", {{"node", node}, {"path", path}}}}}},
                {"samplers",
                 {{{"input", input}, {"output", output}, {"interpolation", interpolation}}}}});
    }

    std::string glb() const {
        nlohmann::json whole = json;
        std::string data = data_;
        while (data.size() % 4 != 0) data += '\0';
        if (!data.empty()) whole["buffers"] = {{{"byteLength", data.size()}}};
        std::string text = whole.dump();
        while (text.size() % 4 != 0) text += ' ';
        std::string chunks = bytesOf(static_cast<std::uint32_t>(text.size())) + "JSON" + text;
        if (!data.empty())
            chunks +=
                bytesOf(static_cast<std::uint32_t>(data.size())) + std::string("BIN\0", 4) + data;
        return "glTF" + bytesOf(std::uint32_t{2}) +
               bytesOf(static_cast<std::uint32_t>(chunks.size() + 12)) + chunks;
    }

    /// As text, with a buffer in a file of that name beside it.
    std::string gltf(const std::string& bufferName) const {
        nlohmann::json whole = json;
        whole["buffers"] = {{{"byteLength", data_.size()}, {"uri", bufferName}}};
        return whole.dump();
    }
    const std::string& data() const { return data_; }

private:
    static int typeOf(std::int8_t) { return 5120; }
    static int typeOf(std::uint8_t) { return 5121; }
    static int typeOf(std::int16_t) { return 5122; }
    static int typeOf(std::uint16_t) { return 5123; }
    static int typeOf(std::uint32_t) { return 5125; }
    static int typeOf(float) { return 5126; }

    std::string data_;
};

/// The corners of the unit square [0, 1] x [0, 1] at z = 0, counter-clockwise from +Z.
inline const std::vector<float> kSquare{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
inline const std::vector<std::uint16_t> kSquareIndices{0, 1, 2, 0, 2, 3};

/// A file with the square as mesh 0, and no node.
inline GltfBuilder squareGltf() {
    GltfBuilder file;
    const int positions = file.vectors(kSquare);
    const int indices = file.accessor(kSquareIndices, "SCALAR", 1);
    file.mesh({{"attributes", {{"POSITION", positions}}}, {"indices", indices}});
    return file;
}

/// The same in a node of the scene.
inline GltfBuilder squareScene() {
    GltfBuilder file = squareGltf();
    file.root({{"mesh", 0}});
    return file;
}

}  // namespace shadowcache::test
