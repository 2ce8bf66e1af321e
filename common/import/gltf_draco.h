#pragma once

#include <string>
#include <string_view>

#include "common/import/draco_decoder.h"
#include "common/import/gltf_accessor.h"
#include "common/import/gltf_object.h"

namespace shadowcache {

/// A primitive of KHR_draco_mesh_compression, decoded.
class DracoPrimitive {
public:
    /// @param extension  of the primitive
    /// @throws Error naming the extension and the cause
    DracoPrimitive(const GltfObject& extension, std::string_view stream);

    bool has(const std::string& attribute) const;

    /// Bytes of an attribute.
    ///
    /// @param accessor  says of what number and kind they are
    /// @throws Error naming the attribute: not in the stream, or of others
    std::string bytes(const std::string& attribute, const GltfAccessor& accessor) const;

    /// Corners of triangles.
    const std::vector<std::uint32_t>& corners() const { return mesh_.corners; }

private:
    GltfObject extension_, attributes_;
    DracoMesh mesh_;
};

}  // namespace shadowcache
