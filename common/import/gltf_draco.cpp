#include "common/import/gltf_draco.h"

#include <fmt/core.h>

#include <algorithm>
#include <limits>

namespace shadowcache {

namespace {

template <class T>
std::string packed(const std::vector<double>& values) {
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

std::string packed(const std::vector<double>& values, GltfType type) {
    switch (type) {
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
            break;
    }
    return packed<float>(values);
}

DracoMesh decoded(const GltfObject& extension, std::string_view stream) {
    std::string cause;
    DracoMesh mesh = decodeDraco(stream, cause);
    if (!cause.empty()) extension.fail(cause);
    if (mesh.corners.empty()) extension.fail("no triangle in the stream");
    return mesh;
}

}  // namespace

DracoPrimitive::DracoPrimitive(const GltfObject& extension, std::string_view stream)
    : extension_(extension),
      attributes_(extension.object("attributes")),
      mesh_(decoded(extension, stream)) {}

bool DracoPrimitive::has(const std::string& attribute) const {
    return attributes_.has(attribute.c_str());
}

std::string DracoPrimitive::bytes(const std::string& attribute,
                                  const GltfAccessor& accessor) const {
    const std::size_t id = attributes_.count(attribute.c_str(), 0);
    const auto found = id > std::numeric_limits<std::uint32_t>::max()
                           ? mesh_.attributes.end()
                           : mesh_.attributes.find(static_cast<std::uint32_t>(id));
    if (found == mesh_.attributes.end())
        extension_.fail(fmt::format("{}: no attribute {} in the stream", attribute, id));
    const DracoAttribute& from = found->second;
    if (from.components != accessor.array.components)
        extension_.fail(fmt::format("{}: {} components, expected {}", attribute, from.components,
                                    accessor.array.components));
    if (mesh_.points != accessor.count)
        extension_.fail(fmt::format("{}: {} in the stream, expected {}", attribute, mesh_.points,
                                    accessor.count));
    return packed(from.values, accessor.array.type);
}

}  // namespace shadowcache
