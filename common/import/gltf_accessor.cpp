#include "common/import/gltf_accessor.h"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <cstring>

namespace shadowcache {

namespace {

static_assert(std::endian::native == std::endian::little, "glTF stores little-endian numbers");

template <class T>
double component(const char* at) {
    T value;
    std::memcpy(&value, at, sizeof value);
    return static_cast<double>(value);
}

double component(GltfType type, const char* at) {
    switch (type) {
        case GltfType::int8:
            return component<std::int8_t>(at);
        case GltfType::uint8:
            return component<std::uint8_t>(at);
        case GltfType::int16:
            return component<std::int16_t>(at);
        case GltfType::uint16:
            return component<std::uint16_t>(at);
        case GltfType::uint32:
            return component<std::uint32_t>(at);
        case GltfType::float32:
            return component<float>(at);
    }
    return 0;
}

/// Largest value of a normalized type, which stands for 1.
double fullScale(GltfType type) {
    switch (type) {
        case GltfType::int8:
            return 127;
        case GltfType::uint8:
            return 255;
        case GltfType::int16:
            return 32767;
        case GltfType::uint16:
            return 65535;
        default:
            return 1;
    }
}

double read(const GltfArray& array, std::size_t element, std::size_t k) {
    return component(array.type, array.bytes.data() + element * array.stride +
                                     k * gltfTypeSize(static_cast<int>(array.type)));
}

}  // namespace

std::size_t gltfTypeSize(int type) {
    switch (static_cast<GltfType>(type)) {
        case GltfType::int8:
        case GltfType::uint8:
            return 1;
        case GltfType::int16:
        case GltfType::uint16:
            return 2;
        case GltfType::uint32:
        case GltfType::float32:
            return 4;
    }
    return 0;
}

std::string badIndexType(int type) {
    for (const GltfType good : {GltfType::uint8, GltfType::uint16, GltfType::uint32})
        if (type == static_cast<int>(good)) return {};
    return fmt::format("type {}, expected 5121, 5123 or 5125", type);
}

std::vector<double> decode(const GltfAccessor& accessor, std::string& cause) {
    const GltfArray& array = accessor.array;
    std::vector<double> values(accessor.count * array.components, 0.0);
    if (!array.bytes.empty())
        for (std::size_t i = 0; i < accessor.count; ++i)
            for (std::size_t k = 0; k < array.components; ++k)
                values[i * array.components + k] = read(array, i, k);
    if (accessor.sparse) {
        const GltfSparse& sparse = *accessor.sparse;
        for (std::size_t i = 0; i < sparse.count; ++i) {
            const double at = read(sparse.indices, i, 0);
            if (at >= static_cast<double>(accessor.count)) {
                cause = fmt::format("sparse index {}, expected 0 to {}", static_cast<long long>(at),
                                    accessor.count - 1);
                return {};
            }
            for (std::size_t k = 0; k < array.components; ++k)
                values[static_cast<std::size_t>(at) * array.components + k] =
                    read(sparse.values, i, k);
        }
    }
    // It means nothing of floats, of which it is an error.
    if (accessor.normalized && array.type != GltfType::float32) {
        const double scale = 1 / fullScale(array.type);
        for (double& value : values) value = std::max(-1.0, value * scale);
    }
    return values;
}

std::vector<std::uint32_t> decodeIndices(const GltfAccessor& accessor, std::string& cause) {
    cause = badIndexType(static_cast<int>(accessor.array.type));
    if (!cause.empty()) return {};
    const std::vector<double> values = decode(accessor, cause);
    return {values.begin(), values.end()};
}

}  // namespace shadowcache
