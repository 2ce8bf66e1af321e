#include "common/import/set_files.h"

#include <cctype>
#include <nlohmann/json.hpp>

#include "common/base/content_hash.h"
#include "common/base/file_bytes.h"
#include "common/base/json_depth.h"
#include "common/base/memory_limit.h"
#include "common/import/gltf_file.h"
#include "common/import/mesh_reader.h"
#include "common/import/obj_looks.h"

namespace shadowcache {

namespace {

namespace fs = std::filesystem;

std::string lowerExtension(const fs::path& file) {
    std::string extension = file.extension().string();
    for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return extension;
}

}  // namespace

std::vector<fs::path> filesOf(const fs::path& file, References references) {
    std::vector<fs::path> files{file};
    if (lowerExtension(file) == ".obj") {
        const std::vector<fs::path> named = objFiles(file, references);
        files.insert(files.end(), named.begin(), named.end());
        return files;
    }
    if (!isGltf(file)) return files;
    const std::string bytes = readFileBytes(file);
    const std::string_view json = gltfJson(bytes);
    // What is wrong with the file is its reader's to say.
    if (!isShallowJson(json)) return files;
    const auto document = nlohmann::json::parse(json, nullptr, false);
    if (!document.is_object()) return files;
    for (const char* kind : {"buffers", "images"}) {
        const auto entries = document.find(kind);
        if (entries == document.end() || !entries->is_array()) continue;
        for (const auto& entry : *entries) {
            if (!entry.is_object() || !entry.contains("uri") || !entry["uri"].is_string()) continue;
            const auto path = gltfNeighbour(file, entry["uri"], References::anywhere);
            if (path && (references == References::anywhere || isBeside(file, *path)))
                files.push_back(*path);
        }
    }
    return files;
}

std::string contentHashOf(std::span<const fs::path> files, References references) {
    ContentHash hash;
    std::error_code ignored;
    for (const fs::path& file : files) {
        if (!fs::is_regular_file(file, ignored)) continue;
        for (const fs::path& part : filesOf(file, references)) {
            // Caches alone are read page by page.
            if (part.extension() != ".vdb") requireFitsMemory(part);
            hash.addText(contentHash(part));
        }
        hash.addText("");  // between a file's parts and the next file
    }
    return hash.text();
}

}  // namespace shadowcache
