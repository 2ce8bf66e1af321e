#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/import/mesh_reader.h"
#include "common/import/references.h"
#include "common/import/texture_islands.h"

namespace shadowcache {

/// A run of faces behind a usemtl line.
struct ObjRun {
    int material = -1;  ///< of ObjLooks::names; -1: before the first
    std::size_t faceCount = 0;
};

/// What an OBJ file says of its looks, besides what RawMesh has room for.
struct ObjLooks {
    std::vector<std::string> libraries;        ///< what stands behind mtllib
    std::vector<std::string> names;            ///< of materials, in the order of their first use
    std::vector<ObjRun> runs;                  ///< in order of the faces, all of them
    std::vector<Vec2d> texcoords;              ///< u, v; v grows upwards in the picture
    std::vector<std::uint32_t> faceTexcoords;  ///< of each corner, kNoVertex for none
    std::vector<bool> colored;                 ///< by vertex: whether it has a colour of its own
};

/// Gives the faces of a mesh the materials of the file's libraries: parts, materials, textures,
/// texture coordinates. Vertices that lie at several places of a picture are split. What is missing
/// or not read is listed in RawMesh::leftOut.
///
/// @param path  the OBJ file
/// @throws Error as readMtl and ObjPictures do
void addObjLooks(const std::filesystem::path& path, References references, const ObjLooks& looks,
                 RawMesh& mesh);

/// Libraries and pictures that an OBJ file names, as far as they exist and may be read.
std::vector<std::filesystem::path> objFiles(const std::filesystem::path& path,
                                            References references);

}  // namespace shadowcache
