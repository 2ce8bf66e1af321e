#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace shadowcache {

/// Component types, by their numbers in glTF.
enum class GltfType : int {
    int8 = 5120,
    uint8 = 5121,
    int16 = 5122,
    uint16 = 5123,
    uint32 = 5125,
    float32 = 5126
};

/// Bytes of a component; 0 if the number is no type.
std::size_t gltfTypeSize(int type);

/// Why indices may not have components of a type, or nothing if they may.
std::string badIndexType(int type);

/// Elements in memory, each of some components, `stride` bytes apart. All lie within `bytes`.
struct GltfArray {
    std::string_view bytes;
    GltfType type = GltfType::float32;
    std::size_t components = 1;
    std::size_t stride = 4;
};

/// Where a sparse accessor differs from its base.
struct GltfSparse {
    std::size_t count = 0;
    GltfArray indices, values;
};

struct GltfAccessor {
    std::size_t count = 0;
    bool normalized = false;  ///< whole numbers stand for [0, 1] or [-1, 1]
    GltfArray array;          ///< without bytes: zeros
    std::optional<GltfSparse> sparse;
};

/// All components, element after element.
///
/// @param cause set if the sparse indices are out of range; the result is then empty
std::vector<double> decode(const GltfAccessor& accessor, std::string& cause);

/// A scalar accessor of whole numbers.
///
/// @param cause set if its type is none of indices, or as by decode(); the result is then empty
std::vector<std::uint32_t> decodeIndices(const GltfAccessor& accessor, std::string& cause);

}  // namespace shadowcache
