#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "common/import/mesh_reader.h"
#include "common/import/mtl_file.h"
#include "common/import/references.h"

namespace shadowcache {

/// The pictures that the materials of an OBJ file name: each is read once, and becomes a texture of
/// the mesh once for each use. Those that are missing, or of a format that is not read, are listed
/// in RawMesh::leftOut.
class ObjPictures {
public:
    /// @param set  the OBJ file
    /// @param mesh  outlives this, as `set` does
    ObjPictures(const std::filesystem::path& set, References references, RawMesh& mesh)
        : set_(set), references_(references), mesh_(mesh) {}

    /// Numbers of textures, -1 where no picture is left of those that are named; null: none is.
    ///
    /// @param library  file that names them
    /// @throws Error naming the picture if it is damaged, or the set if it is outside of its folder
    /// or combined so often that it would fill the memory
    int color(const std::filesystem::path& library, const MtlMap* color, const MtlMap* opacity);
    int roughnessAndMetal(const std::filesystem::path& library, const MtlMap* roughness,
                          const MtlMap* metallic);
    /// Whether a texel of a texture of color() is not opaque.
    bool isTransparent(int texture) const {
        return transparent_[static_cast<std::size_t>(texture)];
    }

private:
    using Combine = Texture (*)(const Texture*, const Texture*);

    int combined(const std::string& kind, Combine combine, const std::filesystem::path& library,
                 const MtlMap* first, const MtlMap* second);
    const Texture* picture(const std::filesystem::path& library, const MtlMap* map,
                           std::string& key);
    const Texture* decoded(const std::filesystem::path& file);

    const std::filesystem::path& set_;
    References references_;
    RawMesh& mesh_;
    std::map<std::filesystem::path, Texture> pictures_;  ///< without texels: not read
    std::map<std::string, int> textures_;                ///< by what they were made of
    std::vector<bool> transparent_;                      ///< by texture
    double texelsRead_ = 0, texelsMade_ = 0;
};

}  // namespace shadowcache
