#include "common/import/gltf_compression.h"

#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#include <fmt/core.h>
#include <tiny_gltf.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

#include "common/base/error.h"
#include "common/import/draco_decoder.h"
#include "common/import/gltf_accessor.h"
#include "common/import/meshopt_decoder.h"

namespace shadowcache {

namespace {

using Json = nlohmann::json;

constexpr const char* kDraco = "KHR_draco_mesh_compression";
constexpr const char* kMeshopt = "EXT_meshopt_compression";

/// An extension of an object of the document, or null.
Json* extensionOf(Json& object, const char* name) {
    const auto extensions = object.is_object() ? object.find("extensions") : object.end();
    if (!object.is_object() || extensions == object.end() || !extensions->is_object())
        return nullptr;
    const auto found = extensions->find(name);
    return found != extensions->end() && found->is_object() ? &*found : nullptr;
}

/// The objects of a list; none where there is no list.
Json::array_t& listOf(Json& object, const char* name) {
    static thread_local Json::array_t none;
    none.clear();
    const auto found = object.is_object() ? object.find(name) : object.end();
    return object.is_object() && found != object.end() && found->is_array()
               ? found->get_ref<Json::array_t&>()
               : none;
}

/// Bytes that any file may become, and those that one of its own may: parts may share what is
/// compressed.
constexpr double kAlwaysAllowed = 0x1p26, kMostPerByte = 1024;

/// Decodes into a model's own buffers.
class Decompressor {
public:
    Decompressor(const std::filesystem::path& path, tinygltf::Model& model)
        : path_(path), model_(model) {
        for (const tinygltf::Buffer& buffer : model.buffers)
            room_ += kMostPerByte * static_cast<double>(buffer.data.size());
    }

    void run() {
        for (std::size_t i = 0; i < model_.bufferViews.size(); ++i)
            if (model_.bufferViews[i].extensions.contains(kMeshopt)) decodeView(i);
        for (std::size_t i = 0; i < model_.meshes.size(); ++i)
            for (tinygltf::Primitive& primitive : model_.meshes[i].primitives)
                if (primitive.extensions.contains(kDraco)) decodePrimitive(i, primitive);
    }

private:
    [[noreturn]] void fail(const std::string& cause) const {
        throwFileError(path_, owner_ + ": " + cause);
    }

    std::size_t number(const tinygltf::Value& value, const char* name) const {
        const tinygltf::Value& found = value.Get(name);
        const double x = found.IsNumber() ? found.GetNumberAsDouble() : -1;
        if (!(x >= 0 && x < 0x1p53)) fail(std::string("no ") + name + ", expected a whole number");
        return static_cast<std::size_t>(x);
    }

    std::string_view bytesOf(const tinygltf::BufferView& view) const {
        if (view.buffer < 0 || static_cast<std::size_t>(view.buffer) >= model_.buffers.size())
            fail(fmt::format("buffer {}, expected 0 to {}", view.buffer,
                             static_cast<long long>(model_.buffers.size()) - 1));
        const auto& data = model_.buffers[static_cast<std::size_t>(view.buffer)].data;
        if (view.byteOffset > data.size() || view.byteLength > data.size() - view.byteOffset)
            fail(fmt::format("{} bytes at {} of a buffer of {}, expected them within it",
                             view.byteLength, view.byteOffset, data.size()));
        return {reinterpret_cast<const char*>(data.data()) + view.byteOffset, view.byteLength};
    }

    int addBuffer(std::string_view bytes) {
        room_ -= static_cast<double>(bytes.size());
        if (room_ < 0) fail("too much data for a file of this size, expected less");
        tinygltf::Buffer& buffer = model_.buffers.emplace_back();
        buffer.data.assign(bytes.begin(), bytes.end());
        return static_cast<int>(model_.buffers.size()) - 1;
    }

    void decodeView(std::size_t index) {
        owner_ = fmt::format("buffer view {}: {}", index, kMeshopt);
        const tinygltf::Value& extension = model_.bufferViews[index].extensions.at(kMeshopt);
        MeshoptView view;
        const auto word = [&](const char* name, std::string& to) {
            if (extension.Get(name).IsString()) to = extension.Get(name).Get<std::string>();
        };
        word("mode", view.mode);
        word("filter", view.filter);
        view.count = number(extension, "count");
        view.stride = number(extension, "byteStride");
        std::string cause;
        const std::string decoded = decodeMeshopt(view, bytesOf(model_.bufferViews[index]), cause);
        if (!cause.empty()) fail(cause);
        tinygltf::BufferView& to = model_.bufferViews[index];
        to.buffer = addBuffer(decoded);
        to.byteOffset = 0;
        to.byteLength = decoded.size();
        to.byteStride = view.mode == "ATTRIBUTES" ? view.stride : 0;
    }

    void decodePrimitive(std::size_t mesh, tinygltf::Primitive& primitive) {
        owner_ = fmt::format("mesh {}: {}", mesh, kDraco);
        const tinygltf::Value& extension = primitive.extensions.at(kDraco);
        const std::size_t view = number(extension, "bufferView");
        if (view >= model_.bufferViews.size())
            fail(fmt::format("buffer view {}, but the file has {}", view,
                             model_.bufferViews.size()));
        std::string cause;
        const DracoMesh decoded = decodeDraco(bytesOf(model_.bufferViews[view]), cause);
        if (!cause.empty()) fail(cause);
        const tinygltf::Value& attributes = extension.Get("attributes");
        for (auto& [name, accessor] : primitive.attributes)
            if (attributes.Has(name))
                accessor =
                    attributeAccessor(name, accessor, number(attributes, name.c_str()), decoded);
        if (!extension.Has("indices")) fail("no indices, expected those of triangles");
        primitive.indices = indexAccessor(number(extension, "indices"), decoded);
        primitive.mode = TINYGLTF_MODE_TRIANGLES;
    }

    const tinygltf::Accessor& accessorAt(const std::string& name, std::size_t index) const {
        if (index >= model_.accessors.size())
            fail(fmt::format("{}: accessor {}, but the file has {}", name,
                             static_cast<std::ptrdiff_t>(index), model_.accessors.size()));
        return model_.accessors[index];
    }

    int addAccessor(tinygltf::Accessor accessor, std::string_view bytes) {
        tinygltf::BufferView& view = model_.bufferViews.emplace_back();
        view.buffer = addBuffer(bytes);
        view.byteLength = bytes.size();
        accessor.bufferView = static_cast<int>(model_.bufferViews.size()) - 1;
        accessor.byteOffset = 0;
        accessor.sparse.isSparse = false;
        model_.accessors.push_back(std::move(accessor));
        return static_cast<int>(model_.accessors.size()) - 1;
    }

    int attributeAccessor(const std::string& name, int index, std::size_t id,
                          const DracoMesh& decoded) {
        const tinygltf::Accessor& accessor = accessorAt(name, static_cast<std::size_t>(index));
        const auto found = id > std::numeric_limits<std::uint32_t>::max()
                               ? decoded.attributes.end()
                               : decoded.attributes.find(static_cast<std::uint32_t>(id));
        if (found == decoded.attributes.end())
            fail(fmt::format("{}: no attribute {} in the stream", name, id));
        const DracoAttribute& from = found->second;
        const int components =
            tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type));
        if (from.components != static_cast<std::size_t>(components))
            fail(fmt::format("{}: {} components, expected {}", name, from.components, components));
        requireCount(name, decoded.points, accessor.count);
        return addAccessor(accessor, encoded(from.values, accessor.componentType));
    }

    int indexAccessor(std::size_t index, const DracoMesh& decoded) {
        tinygltf::Accessor accessor = accessorAt("indices", index);
        // A strip has fewer than the triangles that the stream holds.
        accessor.count = decoded.corners.size();
        if (accessor.count == 0) fail("no triangle in the stream");
        accessor.componentType = static_cast<int>(GltfType::uint32);
        const auto* bytes = reinterpret_cast<const char*>(decoded.corners.data());
        return addAccessor(std::move(accessor), {bytes, 4 * decoded.corners.size()});
    }

    void requireCount(const std::string& name, std::size_t found, std::size_t expected) const {
        if (found != expected)
            fail(fmt::format("{}: {} in the stream, expected {}", name, found, expected));
    }

    template <class T>
    static std::string packed(const std::vector<double>& values) {
        std::string bytes;
        bytes.reserve(values.size() * sizeof(T));
        for (double value : values) {
            if constexpr (std::numeric_limits<T>::is_integer)
                value = std::clamp(value, static_cast<double>(std::numeric_limits<T>::lowest()),
                                   static_cast<double>(std::numeric_limits<T>::max()));
            const T number = static_cast<T>(value);
            bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
        }
        return bytes;
    }

    std::string encoded(const std::vector<double>& values, int type) const {
        switch (static_cast<GltfType>(type)) {
            case GltfType::int8:
                return packed<std::int8_t>(values);
            case GltfType::uint8:
                return packed<std::uint8_t>(values);
            case GltfType::int16:
                return packed<std::int16_t>(values);
            case GltfType::uint16:
                return packed<std::uint16_t>(values);
            case GltfType::uint32:
                return packed<std::uint32_t>(values);
            case GltfType::float32:
                return packed<float>(values);
        }
        fail(fmt::format("component type {}, expected 5120 to 5123, 5125 or 5126", type));
    }

    const std::filesystem::path& path_;
    tinygltf::Model& model_;
    double room_ = kAlwaysAllowed;  ///< [bytes] that may still be decoded
    std::string owner_;             ///< of what is being decoded, for messages
};

/// A compressed buffer view becomes the compressed bytes; the buffers that only stand for decoded
/// ones get a byte.
bool replaceViews(Json& document) {
    bool changed = false;
    for (Json& view : listOf(document, "bufferViews")) {
        const Json* extension = extensionOf(view, kMeshopt);
        if (!extension) continue;
        const Json compressed = *extension;
        for (const char* name : {"buffer", "byteOffset", "byteLength"}) {
            view.erase(name);
            if (compressed.contains(name)) view[name] = compressed[name];
        }
        view.erase("byteStride");
        changed = true;
    }
    for (Json& buffer : listOf(document, "buffers")) {
        const Json* extension = extensionOf(buffer, kMeshopt);
        if (!extension || buffer.contains("uri")) continue;
        buffer["byteLength"] = 1;
        buffer["uri"] = "data:application/octet-stream;base64,AA==";
        changed = true;
    }
    return changed;
}

/// tinygltf wants bytes of all indices.
bool moveIndices(Json& document) {
    bool changed = false;
    for (Json& mesh : listOf(document, "meshes"))
        for (Json& primitive : listOf(mesh, "primitives")) {
            Json* extension = extensionOf(primitive, kDraco);
            if (!extension || !primitive.contains("indices")) continue;
            (*extension)["indices"] = primitive["indices"];
            primitive.erase("indices");
            changed = true;
        }
    return changed;
}

}  // namespace

bool removeFallbacks(Json& document) {
    const bool views = replaceViews(document), indices = moveIndices(document);
    return views || indices;
}

void decompress(const std::filesystem::path& path, tinygltf::Model& model) {
    Decompressor(path, model).run();
}

}  // namespace shadowcache
