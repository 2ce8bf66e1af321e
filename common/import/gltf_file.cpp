#include "common/import/gltf_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <optional>

#include "common/base/error.h"
#include "common/base/file_bytes.h"
#include "common/base/json_depth.h"
#include "common/base/utf8.h"
#include "common/import/gltf_extensions.h"
#include "common/import/meshopt_decoder.h"

namespace shadowcache {

namespace {

using Json = nlohmann::json;

constexpr const char* kMeshopt = "EXT_meshopt_compression";

/// Bytes that any file may become, and those that one of its own may: parts may share what is
/// compressed.
constexpr double kAlwaysAllowed = 0x1p26, kMostPerByte = 1024;

[[noreturn]] void throwIncomplete(const std::filesystem::path& path, const std::string& cause) {
    throwFileError(path, "is not a complete glTF 2.0 file: " + cause);
}

// Of a .glb: its magic number, version and length; then chunks of length, kind and content.
constexpr std::string_view kMagic = "glTF";
constexpr std::size_t kHeader = 12, kChunkHeader = 8;

std::size_t numberAt(std::string_view bytes, std::size_t at) {
    std::uint32_t number = 0;
    std::memcpy(&number, bytes.data() + at, sizeof number);
    return number;
}

/// The content of the first chunk of a kind, as far as it is there; empty if there is none.
std::string_view chunk(std::string_view glb, std::string_view kind) {
    for (std::size_t at = kHeader; at + kChunkHeader <= glb.size();) {
        const std::size_t length = numberAt(glb, at), begin = at + kChunkHeader;
        if (glb.substr(at + 4, 4) == kind) return glb.substr(begin, length);
        at = begin + std::min(length, glb.size() - begin);
    }
    return {};
}

void requireWhole(const std::filesystem::path& path, std::string_view glb) {
    if (glb.size() < kHeader) throwIncomplete(path, "cut short");
    if (numberAt(glb, 4) != 2)
        throwFileError(path, fmt::format("glTF version {}, expected 2.0", numberAt(glb, 4)));
    if (numberAt(glb, 8) > glb.size())
        throwIncomplete(path, fmt::format("{} bytes, expected {}", glb.size(), numberAt(glb, 8)));
}

bool isEqual(std::string_view a, std::string_view b) {
    return std::ranges::equal(
        a, b, [](unsigned char x, unsigned char y) { return std::tolower(x) == std::tolower(y); });
}

bool isData(std::string_view uri) {
    return isEqual(uri.substr(0, 5), "data:");
}

/// Bytes of base64, as far as they are; what follows is the end of it or no base64.
std::string base64Bytes(std::string_view& text) {
    constexpr std::string_view kDigits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    static const std::array<signed char, 256> kValues = [&] {
        std::array<signed char, 256> values{};
        values.fill(-1);
        for (std::size_t i = 0; i < kDigits.size(); ++i)
            values[static_cast<unsigned char>(kDigits[i])] = static_cast<signed char>(i);
        return values;
    }();
    std::string bytes;
    bytes.reserve(text.size() / 4 * 3 + 3);
    std::uint32_t bits = 0;
    int known = 0;
    for (; !text.empty(); text.remove_prefix(1)) {
        const int value = kValues[static_cast<unsigned char>(text.front())];
        if (value < 0) break;
        bits = bits << 6 | static_cast<std::uint32_t>(value);
        known += 6;
        if (known < 8) continue;
        known -= 8;
        bytes += static_cast<char>(bits >> known & 0xff);
    }
    return bytes;
}

/// What a data URI holds, of whatever media type: its bytes say what they are.
std::string dataOf(const GltfObject& owner, const std::string& uri) {
    constexpr std::string_view kBase64 = ";base64";
    const std::size_t comma = std::min(uri.find(','), uri.size());
    const std::string_view head = std::string_view(uri).substr(0, comma);
    if (comma == uri.size() || head.size() < kBase64.size() ||
        !isEqual(head.substr(head.size() - kBase64.size()), kBase64))
        owner.fail("a data URI that is not in base64, expected data:TYPE;base64,...");
    const std::string text = decodedUri(uri.substr(comma + 1));
    std::string_view rest = text;
    std::string bytes = base64Bytes(rest);
    if (rest.find_first_not_of("=") != rest.npos)
        owner.fail(fmt::format("a data URI whose byte {} is no digit of base64",
                               uri.size() - rest.size()));
    return bytes;
}

void requireExtensions(const GltfObject& root) {
    for (const std::string& name : root.texts("extensionsRequired"))
        if (!mayRequireGltfExtension(name))
            root.fail("requires the extension " + name + ", which is not supported");
}

void requireVersion(const GltfObject& root) {
    const GltfObject asset = root.object("asset");
    const std::string version = asset.text("version"), least = asset.text("minVersion");
    if (!asset.has("version")) root.fail("has no asset.version, expected a glTF 2.0 file");
    if (!version.starts_with("2.")) root.fail("glTF version " + version + ", expected 2.0");
    if (!least.empty() && least != "2.0") root.fail("needs glTF " + least + ", expected 2.0");
}

}  // namespace

std::string_view gltfJson(std::string_view bytes) {
    std::string_view text = bytes.starts_with(kMagic) ? chunk(bytes, "JSON") : bytes;
    // Some programs fill up with zeros.
    while (text.ends_with('\0')) text.remove_suffix(1);
    return text;
}

std::optional<std::filesystem::path> gltfNeighbour(const std::filesystem::path& path,
                                                   const std::string& uri, References references) {
    if (isData(uri)) return {};
    for (const std::string& name : {decodedUri(uri), uri})
        if (const auto file = namedFile(path, path, name, references)) return file;
    return {};
}

GltfFile::GltfFile(const std::filesystem::path& path, References references)
    : path_(path), references_(references) {
    const std::string bytes = readFileBytes(path);
    const bool isBinary = bytes.starts_with(kMagic);
    if (isBinary) requireWhole(path, bytes);
    const std::string_view text = gltfJson(bytes);
    if (!isShallowJson(text))
        throwFileError(path, "JSON nested deeper than 256 levels, expected fewer");
    std::string mended;
    isMended_ = mendUtf8(text, mended);
    try {
        json_ = Json::parse(isMended_ ? std::string_view(mended) : text);
    } catch (const Json::exception& e) {
        throwIncomplete(path, e.what());
    }
    if (!json_.is_object()) throwIncomplete(path, "its JSON is no object");
    requireExtensions(root());
    requireVersion(root());
    views_ = root().objects("bufferViews", "buffer view");
    images_ = root().objects("images", "image");
    known_.resize(views_.size());
    readBuffers(isBinary ? chunk(bytes, std::string_view("BIN\0", 4)) : std::string_view());
}

void GltfFile::readBuffers(std::string_view chunk) {
    for (const GltfObject& buffer : root().objects("buffers", "buffer")) {
        storage_.push_back(bufferBytes(buffer, chunk, storage_.empty()));
        // What only stands for decoded views has no bytes.
        const bool isStandIn = !buffer.has("uri") && buffer.hasExtension(kMeshopt);
        const std::size_t found = storage_.back().size();
        size_ += found;
        const std::size_t expected = isStandIn ? 0 : buffer.count("byteLength", 0);
        if (found < expected)
            throwIncomplete(
                path_, fmt::format("{}: {} bytes, expected {}", buffer.owner(), found, expected));
    }
    buffers_ = storage_.size();
    room_ = kAlwaysAllowed + kMostPerByte * static_cast<double>(size_);
}

std::string GltfFile::bufferBytes(const GltfObject& buffer, std::string_view chunk,
                                  bool isFirst) const {
    const std::string uri = buffer.text("uri");
    if (uri.empty()) return isFirst ? std::string(chunk) : std::string();
    if (isData(uri)) return dataOf(buffer, uri);
    const auto file = gltfNeighbour(path_, uri, references_);
    if (!file) throwIncomplete(path_, fmt::format("{}: {} was not found", buffer.owner(), uri));
    return readFileBytes(*file);
}

std::string_view GltfFile::within(const GltfObject& view) const {
    const int buffer = view.index("buffer", buffers_);
    if (buffer < 0) view.fail("no buffer");
    const std::string& bytes = storage_[static_cast<std::size_t>(buffer)];
    const std::size_t offset = view.count("byteOffset", 0), length = view.count("byteLength", 0);
    if (offset > bytes.size() || length > bytes.size() - offset)
        view.fail(fmt::format("{} bytes at {} of a buffer of {}, expected them within it", length,
                              offset, bytes.size()));
    return std::string_view(bytes).substr(offset, length);
}

std::string GltfFile::decoded(const GltfObject& extension) const {
    MeshoptView view;
    view.mode = extension.text("mode");
    if (extension.has("filter")) view.filter = extension.text("filter");
    view.count = extension.count("count", 0);
    view.stride = extension.count("byteStride", 0);
    std::string cause;
    std::string bytes = decodeMeshopt(view, within(extension), cause);
    if (!cause.empty()) extension.fail(cause);
    return bytes;
}

std::string_view GltfFile::view(const GltfObject& user, int view) {
    if (view < 0) user.fail("no buffer view");
    const auto number = static_cast<std::size_t>(view);
    std::optional<View>& known = known_[number];
    if (known) return known->bytes;
    const GltfObject& from = views_[number];
    if (!from.hasExtension(kMeshopt)) {
        known = View{within(from), from.count("byteStride", 0)};
        return known->bytes;
    }
    const GltfObject extension = from.extension(kMeshopt);
    const bool strided = extension.text("mode") == "ATTRIBUTES";
    known =
        View{keep(extension, decoded(extension)), strided ? extension.count("byteStride", 0) : 0};
    return known->bytes;
}

std::size_t GltfFile::stride(int view) const {
    return known_[static_cast<std::size_t>(view)]->stride;
}

std::string_view GltfFile::picture(int image, std::string& name) {
    const GltfObject& from = images_[static_cast<std::size_t>(image)];
    const std::string uri = from.text("uri");
    name = fmt::format("image {}{}", image,
                       uri.empty() || isData(uri) ? "" : fmt::format(" ({})", uri));
    if (uri.empty()) {
        const int number = from.index("bufferView", views_.size(), "buffer view");
        return number < 0 ? std::string_view() : view(from, number);
    }
    if (isData(uri)) return storage_.emplace_back(dataOf(from, uri));
    const auto file = gltfNeighbour(path_, uri, references_);
    return file ? storage_.emplace_back(readFileBytes(*file)) : std::string_view();
}

std::string_view GltfFile::keep(const GltfObject& user, std::string bytes) {
    room_ -= static_cast<double>(bytes.size());
    if (room_ < 0) user.fail("too much data for a file of this size, expected less");
    return storage_.emplace_back(std::move(bytes));
}

}  // namespace shadowcache
