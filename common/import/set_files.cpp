#include "common/import/set_files.h"

#include <cctype>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>

#include "common/base/content_hash.h"
#include "common/base/file_bytes.h"
#include "common/base/json_depth.h"
#include "common/import/obj_looks.h"

namespace shadowcache {

namespace {

namespace fs = std::filesystem;

std::string lowerExtensionOf(const fs::path& file) {
    std::string extension = file.extension().string();
    for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return extension;
}

/// The JSON of a .gltf or .glb file; empty if it is neither.
std::string gltfJson(const fs::path& file) {
    const std::string extension = lowerExtensionOf(file);
    if (extension != ".gltf" && extension != ".glb") return "";
    std::string bytes = readFileBytes(file);
    constexpr std::size_t kBegin = 20;  // of the first chunk's content
    if (!bytes.starts_with("glTF")) return bytes;
    if (bytes.size() < kBegin) return "";
    std::uint32_t length = 0;
    std::memcpy(&length, bytes.data() + 12, sizeof length);
    return bytes.substr(kBegin, length);
}

}  // namespace

std::vector<fs::path> filesOf(const fs::path& file, References references) {
    std::vector<fs::path> files{file};
    if (lowerExtensionOf(file) == ".obj") {
        const std::vector<fs::path> named = objFiles(file, references);
        files.insert(files.end(), named.begin(), named.end());
        return files;
    }
    const std::string json = gltfJson(file);
    // What is wrong with the file is its reader's to say.
    if (!isShallowJson(json)) return files;
    const auto document = nlohmann::json::parse(json, nullptr, false);
    if (!document.is_object()) return files;
    for (const char* kind : {"buffers", "images"}) {
        const auto entries = document.find(kind);
        if (entries == document.end() || !entries->is_array()) continue;
        for (const auto& entry : *entries) {
            if (!entry.is_object() || !entry.contains("uri") || !entry["uri"].is_string()) continue;
            const std::string uri = entry["uri"];
            std::error_code ignored;
            for (const std::string& name : {uri, decodedUri(uri)}) {
                if (uri.starts_with("data:")) break;
                const fs::path path = referencedFile(file, name);
                if (!fs::is_regular_file(path, ignored)) continue;
                if (references == References::inside && !isBeside(file, path)) continue;
                files.push_back(path);
                break;
            }
        }
    }
    return files;
}

std::string contentHashOf(std::span<const fs::path> files, References references) {
    ContentHash hash;
    std::error_code ignored;
    for (const fs::path& file : files) {
        if (!fs::is_regular_file(file, ignored)) continue;
        for (const fs::path& part : filesOf(file, references)) hash.addText(contentHash(part));
        hash.addText("");  // between a file's parts and the next file
    }
    return hash.text();
}

}  // namespace shadowcache
