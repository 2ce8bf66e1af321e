#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace shadowcache {

/// Numbers of all points, one after the other.
struct DracoAttribute {
    std::size_t components = 0;
    std::vector<double> values;
};

/// A mesh of a Draco stream.
struct DracoMesh {
    std::size_t points = 0;
    std::vector<std::uint32_t> corners;                  ///< three a triangle; each below `points`
    std::map<std::uint32_t, DracoAttribute> attributes;  ///< by their ids in the stream
};

/// Decodes a Draco stream.
///
/// @param cause  set if it is none, or damaged; the result is then empty
DracoMesh decodeDraco(std::string_view bytes, std::string& cause);

}  // namespace shadowcache
