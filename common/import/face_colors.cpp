#include "common/import/face_colors.h"

#include <array>
#include <bit>
#include <map>

namespace shadowcache {

namespace {

class FaceColors {
public:
    explicit FaceColors(RawMesh& mesh)
        : mesh_(mesh),
          ownNormals_(mesh.normals.size() == mesh.vertices.size()),
          used_(mesh.vertices.size(), false) {
        mesh.colors.assign(mesh.vertices.size(), kUncolored);
    }

    void paint(std::uint32_t& vertex, const Rgb& color) {
        if (vertex >= used_.size()) {
            vertex = kNoVertex;  // what names no vertex of the file must not name a copy
            return;
        }
        if (!used_[vertex]) {
            used_[vertex] = true;
            mesh_.colors[vertex] = color;
        } else if (mesh_.colors[vertex] != color) {
            vertex = copyOf(vertex, color);
        }
    }

private:
    std::uint32_t copyOf(std::uint32_t vertex, const Rgb& color) {
        const auto bits = [](float x) { return std::bit_cast<std::uint32_t>(x); };
        const auto number = static_cast<std::uint32_t>(mesh_.vertices.size());
        const auto [copy, isNew] =
            copies_.try_emplace({vertex, bits(color.x), bits(color.y), bits(color.z)}, number);
        if (!isNew) return copy->second;
        mesh_.vertices.push_back(Vec3d(mesh_.vertices[vertex]));
        mesh_.colors.push_back(color);
        if (ownNormals_) mesh_.normals.push_back(Vec3d(mesh_.normals[vertex]));
        return number;
    }

    RawMesh& mesh_;
    bool ownNormals_;         ///< one for each vertex
    std::vector<bool> used_;  ///< by vertex of the file
    std::map<std::array<std::uint32_t, 4>, std::uint32_t> copies_;
};

}  // namespace

void colorFaces(const std::vector<Rgb>& colors, RawMesh& mesh) {
    if (!mesh.colors.empty()) {
        ++mesh.leftOut["colours of the faces (the vertices have their own)"];
        return;
    }
    FaceColors painter(mesh);
    std::size_t corner = 0;
    for (std::size_t face = 0; face < mesh.faceSizes.size(); ++face)
        for (std::uint32_t k = mesh.faceSizes[face]; k > 0; --k)
            painter.paint(mesh.faceVertices[corner++],
                          face < colors.size() ? colors[face] : kUncolored);
}

}  // namespace shadowcache
