#include "common/import/gltf_file.h"

// Without the parts that decode pictures: they stay as they are until a texture is needed.
#define TINYGLTF_IMPLEMENTATION
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#include <fmt/core.h>
#include <tiny_gltf.h>

#include <cstring>
#include <limits>

#include "common/base/error.h"
#include "common/base/file_bytes.h"
#include "common/base/json_depth.h"
#include "common/import/gltf_compression.h"
#include "common/import/gltf_extensions.h"
#include "common/import/gltf_shapes.h"
#include "common/import/gltf_uris.h"

namespace shadowcache {

namespace {

/// Of a file, as tinygltf is told.
std::string folderOf(const std::filesystem::path& path) {
    return path.parent_path().lexically_normal().string();
}

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

/// The objects of an array of a glTF document; empty where it has none.
const nlohmann::json& objects(const nlohmann::json& document, const char* array) {
    static const nlohmann::json kNone = nlohmann::json::array();
    const auto at = document.find(array);
    return at != document.end() && at->is_array() ? *at : kNone;
}

/// A number of an object of a glTF document; 0 where it is none that tinygltf would take.
std::size_t number(const nlohmann::json& object, const char* name) {
    const auto at = object.is_object() ? object.find(name) : object.end();
    return at != object.end() && at->is_number_integer() ? at->get<std::size_t>() : 0;
}

void requireExtensions(const std::filesystem::path& path, const nlohmann::json& document) {
    for (const auto& name : objects(document, "extensionsRequired"))
        if (name.is_string() && !mayRequireGltfExtension(name.get<std::string>()))
            throwFileError(path, "requires the extension " + name.get<std::string>() +
                                     ", which is not supported");
}

/// tinygltf takes the address of a picture's first byte without a look at the buffer's size.
void requireViewsInBuffers(const std::filesystem::path& path, const nlohmann::json& document) {
    const auto& buffers = objects(document, "buffers");
    for (const auto& view : objects(document, "bufferViews")) {
        const auto buffer = static_cast<std::uint32_t>(number(view, "buffer"));
        const std::size_t first = number(view, "byteOffset");
        const std::size_t size =
            buffer < buffers.size() ? number(buffers[buffer], "byteLength") : 0;
        if (buffer < buffers.size() && first >= size)
            throwFileError(
                path, fmt::format("a buffer view at byte {} of a buffer of {}, expected it within",
                                  first, size));
    }
}

// Of a .glb: the first chunk's length, kind and content.
constexpr std::size_t kChunk = 12, kContent = 20;

/// The JSON of a .gltf or .glb file.
std::string_view jsonOf(std::string_view bytes) {
    if (!bytes.starts_with("glTF") || bytes.size() < kContent) return bytes;
    std::uint32_t length = 0;
    std::memcpy(&length, bytes.data() + kChunk, sizeof length);
    return bytes.substr(kContent, length);
}

/// The bytes of a .glb with another JSON.
std::string withJson(std::string_view glb, std::string json) {
    while (json.size() % 4 != 0) json += ' ';
    const std::string_view rest = glb.substr(kContent + jsonOf(glb).size());
    const auto length = static_cast<std::uint32_t>(json.size());
    const auto total = static_cast<std::uint32_t>(kContent + json.size() + rest.size());
    std::string bytes(glb.substr(0, kContent));
    std::memcpy(bytes.data() + kChunk, &length, sizeof length);
    std::memcpy(bytes.data() + kChunk - sizeof total, &total, sizeof total);
    return bytes.append(json).append(rest);
}

/// The files beside a glTF file, as tinygltf may read them: only those that exist, are regular, and
/// may be named.
class Neighbours {
public:
    Neighbours(const std::filesystem::path& set, References references)
        : set_(set), references_(references) {}

    tinygltf::FsCallbacks callbacks() {
        return {[](const std::string& file, void* self) { return of(self).mayRead(file); },
                [](const std::string& file, void* self) { return of(self).place(file); },
                [](std::vector<unsigned char>* out, std::string*, const std::string& file, void*) {
                    const std::string bytes = readFileBytes(file);
                    out->assign(bytes.begin(), bytes.end());
                    return true;
                },
                [](std::string*, const std::string&, const std::vector<unsigned char>&, void*) {
                    return false;
                },
                this};
    }

    /// The first file that exists and may not be named; empty if there was none.
    const std::string& refused() const { return refused_; }

private:
    static Neighbours& of(void* self) { return *static_cast<Neighbours*>(self); }

    /// tinygltf puts the folder in front of every URI, absolute ones included.
    std::string place(const std::string& file) const {
        const std::string folder = folderOf(set_) + "/";
        return file.starts_with(folder + "/") ? file.substr(folder.size()) : file;
    }

    bool mayRead(const std::string& file) {
        std::error_code ignored;
        if (!std::filesystem::is_regular_file(file, ignored)) return false;
        if (references_ == References::anywhere || isBeside(set_, file)) return true;
        if (refused_.empty()) refused_ = file;
        return false;
    }

    const std::filesystem::path& set_;
    References references_;
    std::string refused_;
};

}  // namespace

tinygltf::Model readGltfFile(const std::filesystem::path& path, References references) {
    std::string bytes = readFileBytes(path);
    if (bytes.size() > std::numeric_limits<std::uint32_t>::max())
        throwFileError(path, "larger than 4 GB, expected a smaller glTF file");
    const bool binary = bytes.starts_with("glTF");
    if (!isShallowJson(jsonOf(bytes)))
        throwFileError(path, "JSON nested deeper than 256 levels, expected fewer");
    // What is no object is tinygltf's to refuse.
    auto document = nlohmann::json::parse(jsonOf(bytes), nullptr, false);
    if (document.is_object()) {
        requireExtensions(path, document);
        requireShapes(path, document);
        const bool urisChanged = mendUris(path, document), changed = removeFallbacks(document);
        if (urisChanged || changed) {
            const std::string plain =
                document.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
            bytes = binary ? withJson(bytes, plain) : plain;
        }
        requireViewsInBuffers(path, document);
    }
    const auto size = static_cast<unsigned int>(bytes.size());

    tinygltf::TinyGLTF loader;
    loader.SetImageLoader(keepEncoded, nullptr);
    Neighbours neighbours(path, references);
    loader.SetFsCallbacks(neighbours.callbacks());
    tinygltf::Model model;
    std::string error, warning;
    bool read = false;
    try {
        const std::string folder = folderOf(path);
        read =
            binary
                ? loader.LoadBinaryFromMemory(&model, &error, &warning,
                                              reinterpret_cast<const unsigned char*>(bytes.data()),
                                              size, folder)
                : loader.LoadASCIIFromString(&model, &error, &warning, bytes.data(), size, folder);
    } catch (const std::exception& e) {
        error = e.what();
    }
    if (!neighbours.refused().empty())
        throwFileError(path, "names " + neighbours.refused() +
                                 ", which is outside of its folder: expected a file beside it, or "
                                 "--allow-external");
    if (!read) throwFileError(path, "is not a complete glTF 2.0 file: " + firstLine(error));
    if (!model.asset.version.starts_with("2."))
        throwFileError(path, "glTF version " + model.asset.version + ", expected 2.0");
    if (!model.asset.minVersion.empty() && model.asset.minVersion != "2.0")
        throwFileError(path, "needs glTF " + model.asset.minVersion + ", expected 2.0");
    decompress(path, model);
    return model;
}

}  // namespace shadowcache
