#include "common/import/gltf_file.h"

// Without the parts that decode pictures: they stay as they are until a texture is needed.
#define TINYGLTF_IMPLEMENTATION
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#include <tiny_gltf.h>

#include <algorithm>
#include <cstring>
#include <limits>

#include "common/base/error.h"
#include "common/base/file_bytes.h"
#include "common/base/json_depth.h"
#include "common/import/gltf_material.h"

namespace shadowcache {

namespace {

/// Extensions of which nothing is needed here, or all is done.
constexpr const char* kKnownExtensions[] = {"KHR_mesh_quantization", "KHR_texture_transform",
                                            "KHR_lights_punctual"};

std::string firstLine(const std::string& text) {
    return text.substr(0, text.find('\n'));
}

/// Keeps a picture's bytes as they are; those in buffers are looked up later, where they are
/// checked.
bool keepEncoded(tinygltf::Image* image, int, std::string*, std::string*, int, int,
                 const unsigned char* bytes, int size, void*) {
    if (image->bufferView < 0) image->image.assign(bytes, bytes + size);
    return true;
}

}  // namespace

tinygltf::Model readGltfFile(const std::filesystem::path& path) {
    const std::string bytes = readFileBytes(path);
    if (bytes.size() > std::numeric_limits<std::uint32_t>::max())
        throwFileError(path, "larger than 4 GB, expected a smaller glTF file");
    const auto size = static_cast<unsigned int>(bytes.size());
    const bool binary = bytes.starts_with("glTF");
    std::string_view json = bytes;
    if (binary && bytes.size() >= 20) {
        std::uint32_t length = 0;
        std::memcpy(&length, bytes.data() + 12, sizeof length);
        json = json.substr(20, length);
    }
    if (!isShallowJson(json))
        throwFileError(path, "JSON nested deeper than 256 levels, expected fewer");

    tinygltf::TinyGLTF loader;
    loader.SetImageLoader(keepEncoded, nullptr);
    tinygltf::Model model;
    std::string error, warning;
    bool read = false;
    try {
        const std::string folder = path.parent_path().string();
        read =
            binary
                ? loader.LoadBinaryFromMemory(&model, &error, &warning,
                                              reinterpret_cast<const unsigned char*>(bytes.data()),
                                              size, folder)
                : loader.LoadASCIIFromString(&model, &error, &warning, bytes.data(), size, folder);
    } catch (const std::exception& e) {
        error = e.what();
    }
    if (!read) throwFileError(path, "is not a complete glTF 2.0 file: " + firstLine(error));
    if (!model.asset.version.starts_with("2."))
        throwFileError(path, "glTF version " + model.asset.version + ", expected 2.0");
    for (const std::string& name : model.extensionsRequired)
        if (!isMaterialExtension(name) &&
            std::find(std::begin(kKnownExtensions), std::end(kKnownExtensions), name) ==
                std::end(kKnownExtensions))
            throwFileError(path, "requires the extension " + name + ", which is not supported");
    return model;
}

}  // namespace shadowcache
