#pragma once

#include "common/import/gltf_material.h"
#include "common/import/mtl_file.h"
#include "common/import/obj_pictures.h"

namespace shadowcache {

/// A material of an OBJ file's library, in the terms of glTF's.
///
/// @param library  file that it is from
/// @param coloredVertices  takes the vertices' colours in place of Kd
/// @throws Error as ObjPictures does
GltfMaterial objMaterial(const MtlMaterial& from, const std::filesystem::path& library,
                         bool coloredVertices, ObjPictures& pictures);

}  // namespace shadowcache
