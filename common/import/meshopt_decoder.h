#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace shadowcache {

/// How a buffer view is compressed. [EXT_meshopt_compression]
struct MeshoptView {
    std::string mode;             ///< ATTRIBUTES, TRIANGLES or INDICES
    std::string filter = "NONE";  ///< or OCTAHEDRAL, QUATERNION, EXPONENTIAL
    std::size_t count = 0;        ///< of its elements
    std::size_t stride = 0;       ///< bytes of each
};

/// Bytes of all elements.
///
/// @param cause  set if the numbers do not fit together or the bytes are damaged; the result is
/// then empty
std::string decodeMeshopt(const MeshoptView& view, std::string_view bytes, std::string& cause);

}  // namespace shadowcache
