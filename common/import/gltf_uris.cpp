#include "common/import/gltf_uris.h"

#include <algorithm>
#include <cctype>
#include <nlohmann/json.hpp>
#include <string>

#include "common/base/error.h"
#include "common/import/references.h"

namespace shadowcache {

namespace {

using Json = nlohmann::json;

constexpr std::string_view kData = "data:", kBase64 = ";base64",
                           kKnown = "application/octet-stream";

bool isEqual(std::string_view a, std::string_view b) {
    return std::ranges::equal(
        a, b, [](unsigned char x, unsigned char y) { return std::tolower(x) == std::tolower(y); });
}

/// What data are, their bytes say; tinygltf knows a few media types only.
bool renameData(const std::filesystem::path& path, std::string& uri) {
    const std::size_t comma = uri.find(',');
    const std::string_view head = std::string_view(uri).substr(0, comma);
    if (comma == uri.npos || head.size() < kData.size() + kBase64.size() ||
        !isEqual(head.substr(head.size() - kBase64.size()), kBase64))
        throwFileError(path, "a data URI that is not in base64, expected data:TYPE;base64,...");
    std::string known = std::string(kData).append(kKnown).append(kBase64);
    if (head == known) return false;
    uri = known.append(uri, comma);
    return true;
}

/// A buffer may be the first bytes of its file. [glTF 2.0, Sec. 3.6.1.1]
bool takeWholeFile(const std::filesystem::path& path, const std::string& uri, Json& buffer) {
    const auto length = buffer.find("byteLength");
    if (length == buffer.end() || !length->is_number_unsigned()) return false;
    for (const std::string& name : {decodedUri(uri), uri}) {
        std::error_code ignored;
        const std::filesystem::path file = referencedFile(path, name);
        if (!std::filesystem::is_regular_file(file, ignored)) continue;
        const std::uintmax_t size = std::filesystem::file_size(file, ignored);
        if (ignored || size <= length->get<std::uint64_t>()) return false;
        *length = size;
        return true;
    }
    return false;
}

}  // namespace

bool isDataUri(std::string_view uri) {
    return isEqual(uri.substr(0, kData.size()), kData);
}

bool mendUris(const std::filesystem::path& path, Json& document) {
    bool changed = false;
    for (const char* kind : {"buffers", "images"}) {
        const auto entries = document.find(kind);
        if (entries == document.end() || !entries->is_array()) continue;
        const bool isBuffer = std::string_view(kind) == "buffers";
        for (Json& entry : *entries) {
            const auto uri = entry.is_object() ? entry.find("uri") : entry.end();
            if (!entry.is_object() || uri == entry.end() || !uri->is_string()) continue;
            auto& text = uri->get_ref<std::string&>();
            if (isDataUri(text))
                changed = renameData(path, text) || changed;
            else if (isBuffer)
                changed = takeWholeFile(path, std::string(text), entry) || changed;
        }
    }
    return changed;
}

}  // namespace shadowcache
