#pragma once

#include "common/import/gltf_document.h"
#include "common/import/gltf_pose.h"
#include "common/import/mesh_reader.h"

namespace shadowcache {

/// What becomes of a mesh's pictures.
enum class GltfPictures { decode, leave };

/// The meshes of a pose. Shapes of several placements are kept once, with instances; with
/// `alwaysShared`, so are all others, and instances[i] is of placements[i].
///
/// @throws Error naming the file and the mesh: targets or joints that do not fit, no picture
RawMesh gltfMesh(const GltfDocument& document, const GltfPose& pose, bool alwaysShared,
                 GltfPictures pictures = GltfPictures::decode);

}  // namespace shadowcache
