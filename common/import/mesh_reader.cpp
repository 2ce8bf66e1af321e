#include "common/import/mesh_reader.h"

#include <fmt/core.h>

#include <OpenMesh/Core/IO/importer/BaseImporter.hh>
#include <OpenMesh/Core/IO/reader/OMReader.hh>
#include <OpenMesh/Core/IO/writer/OMWriter.hh>
#include <OpenMesh/Core/Mesh/ArrayKernel.hh>
#include <OpenMesh/Core/System/omstream.hh>
#include <algorithm>
#include <cctype>
#include <string>

#include "common/base/error.h"
#include "common/base/file_bytes.h"
#include "common/base/text_streams.h"
#include "common/import/om_check.h"
#include "common/import/vertex_colors.h"

namespace shadowcache {

namespace {

using OpenMesh::FaceHandle;
using OpenMesh::HalfedgeHandle;
using OpenMesh::VertexHandle;

/// Takes what OpenMesh's reader finds as plain arrays. OpenMesh's own meshes refuse non-manifold
/// faces and drop degenerate ones; half-edge links are only walked here to list a face's corners.
class SoupImporter final : public OpenMesh::IO::BaseImporter {
public:
    RawMesh mesh;

    /// Lists the corners of faces that were given by a half-edge; false if a link leads nowhere.
    bool finishFaces() {
        for (const int first : faceHalfedges_) {
            std::uint32_t size = 0;
            int halfedge = first;
            do {
                if (halfedge < 0 || static_cast<std::size_t>(halfedge) >= toVertex_.size() ||
                    size > toVertex_.size()) {
                    return false;
                }
                mesh.faceVertices.push_back(toVertex_[static_cast<std::size_t>(halfedge)]);
                halfedge = next_[static_cast<std::size_t>(halfedge)];
                ++size;
            } while (halfedge != first);
            mesh.faceSizes.push_back(size);
        }
        return true;
    }

    VertexHandle add_vertex(const OpenMesh::Vec3f& p) override {
        return add_vertex(OpenMesh::Vec3d(p));
    }
    VertexHandle add_vertex(const OpenMesh::Vec3d& p) override {
        mesh.vertices.emplace_back(p[0], p[1], p[2]);
        return VertexHandle(static_cast<int>(mesh.vertices.size()) - 1);
    }
    VertexHandle add_vertex() override { return add_vertex(OpenMesh::Vec3d(0.0)); }
    void set_point(VertexHandle v, const OpenMesh::Vec3f& p) override {
        const OpenMesh::Vec3d q(p);
        if (known(v)) mesh.vertices[index(v)] = Vec3d(q[0], q[1], q[2]);
    }

    FaceHandle add_face(const VHandles& corners) override {
        for (const VertexHandle v : corners) {
            mesh.faceVertices.push_back(known(v) ? static_cast<std::uint32_t>(v.idx()) : kNoVertex);
        }
        mesh.faceSizes.push_back(static_cast<std::uint32_t>(corners.size()));
        return FaceHandle(static_cast<int>(n_faces()) - 1);
    }
    FaceHandle add_face(HalfedgeHandle halfedge) override {
        faceHalfedges_.push_back(halfedge.idx());
        return FaceHandle(static_cast<int>(n_faces()) - 1);
    }
    HalfedgeHandle add_edge(VertexHandle from, VertexHandle to) override {
        for (const VertexHandle v : {to, from}) {
            toVertex_.push_back(known(v) ? static_cast<std::uint32_t>(v.idx()) : kNoVertex);
            next_.push_back(-1);
        }
        return HalfedgeHandle(static_cast<int>(toVertex_.size()) - 2);
    }
    void set_next(HalfedgeHandle halfedge, HalfedgeHandle next) override {
        const auto i = static_cast<std::size_t>(halfedge.idx());
        if (halfedge.idx() >= 0 && i < next_.size()) next_[i] = next.idx();
    }

    /// Turns the colours that were set into linear ones.
    void finishColors() {
        ColorScale scale(colorNumbers_);
        for (const Rgb& color : mesh.colors)
            for (int k = 0; k < 3; ++k) scale.see(static_cast<double>(color[k]));
        mesh.badColors = decodeColors(scale, mesh.colors);
    }

    void set_color(VertexHandle v, const OpenMesh::Vec3uc& c) override {
        setColor(v, OpenMesh::Vec3f(c), ColorNumbers::bytes);
    }
    void set_color(VertexHandle v, const OpenMesh::Vec4uc& c) override {
        set_color(v, OpenMesh::Vec3uc(c[0], c[1], c[2]));
    }
    void set_color(VertexHandle v, const OpenMesh::Vec3f& c) override {
        setColor(v, c, ColorNumbers::any);
    }
    void set_color(VertexHandle v, const OpenMesh::Vec4f& c) override {
        set_color(v, OpenMesh::Vec3f(c[0], c[1], c[2]));
    }

    void set_normal(VertexHandle v, const OpenMesh::Vec3f& n) override {
        set_normal(v, OpenMesh::Vec3d(n));
    }
    void set_normal(VertexHandle v, const OpenMesh::Vec3d& n) override {
        if (!known(v)) return;
        mesh.normals.resize(mesh.vertices.size(), Vec3d(0.0));
        mesh.normals[index(v)] = Vec3d(n[0], n[1], n[2]);
    }

    OpenMesh::BaseKernel* kernel() override { return &kernel_; }
    std::size_t n_vertices() const override { return mesh.vertices.size(); }
    std::size_t n_faces() const override { return mesh.faceSizes.size() + faceHalfedges_.size(); }
    std::size_t n_edges() const override { return toVertex_.size() / 2; }

    // What follows is in the files and of no use here.
    void add_face_texcoords(FaceHandle, VertexHandle,
                            const std::vector<OpenMesh::Vec2f>&) override {}
    void add_face_texcoords(FaceHandle, VertexHandle,
                            const std::vector<OpenMesh::Vec3f>&) override {}
    void set_face_texindex(FaceHandle, int) override {}
    void set_halfedge(VertexHandle, HalfedgeHandle) override {}
    void set_texcoord(VertexHandle, const OpenMesh::Vec2f&) override {}
    void set_texcoord(VertexHandle, const OpenMesh::Vec3f&) override {}
    void set_texcoord(HalfedgeHandle, const OpenMesh::Vec2f&) override {}
    void set_texcoord(HalfedgeHandle, const OpenMesh::Vec3f&) override {}
    void set_status(VertexHandle, const OpenMesh::Attributes::StatusInfo&) override {}
    void set_status(HalfedgeHandle, const OpenMesh::Attributes::StatusInfo&) override {}
    void set_status(OpenMesh::EdgeHandle, const OpenMesh::Attributes::StatusInfo&) override {}
    void set_status(FaceHandle, const OpenMesh::Attributes::StatusInfo&) override {}
    void set_face(HalfedgeHandle, FaceHandle) override {}
    void request_face_texcoords2D() override {}
    void set_color(OpenMesh::EdgeHandle, const OpenMesh::Vec3uc&) override {}
    void set_color(OpenMesh::EdgeHandle, const OpenMesh::Vec4uc&) override {}
    void set_color(OpenMesh::EdgeHandle, const OpenMesh::Vec3f&) override {}
    void set_color(OpenMesh::EdgeHandle, const OpenMesh::Vec4f&) override {}
    void set_normal(FaceHandle, const OpenMesh::Vec3f&) override {}
    void set_normal(FaceHandle, const OpenMesh::Vec3d&) override {}
    void set_color(FaceHandle, const OpenMesh::Vec3uc&) override {}
    void set_color(FaceHandle, const OpenMesh::Vec4uc&) override {}
    void set_color(FaceHandle, const OpenMesh::Vec3f&) override {}
    void set_color(FaceHandle, const OpenMesh::Vec4f&) override {}
    void add_texture_information(int, std::string) override {}

private:
    static std::size_t index(VertexHandle v) { return static_cast<std::size_t>(v.idx()); }
    bool known(VertexHandle v) const { return v.idx() >= 0 && index(v) < mesh.vertices.size(); }
    /// All colours of a file are of one type.
    void setColor(VertexHandle v, const OpenMesh::Vec3f& c, ColorNumbers numbers) {
        if (!known(v)) return;
        colorNumbers_ = numbers;
        mesh.colors.resize(mesh.vertices.size(), Rgb(numbers == ColorNumbers::bytes ? 255.0f : 1));
        mesh.colors[index(v)] = Rgb(c[0], c[1], c[2]);
    }

    OpenMesh::ArrayKernel kernel_;
    ColorNumbers colorNumbers_ = ColorNumbers::bytes;
    std::vector<int> faceHalfedges_;
    std::vector<std::uint32_t> toVertex_;
    std::vector<int> next_;
};

struct MeshFormat {
    const char* extension;
    MeshReader read;
};

constexpr MeshFormat kFormats[] = {
    {".glb", nullptr}, {".gltf", nullptr}, {".obj", nullptr}, {".off", readOff},
    {".om", readOm},   {".ply", readPly},  {".stl", readStl},
};

std::string lowerExtension(const std::filesystem::path& path) {
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension;
}

}  // namespace

bool isGltf(const std::filesystem::path& path) {
    const std::string extension = lowerExtension(path);
    return extension == ".glb" || extension == ".gltf";
}

RawMesh readOm(const std::filesystem::path& path) {
    std::string bytes = readFileBytes(path);
    const OmCounts counts = checkOm(path, bytes, OpenMesh::IO::_OMWriter_::get_version());

    TextReader stream(std::move(bytes));
    SoupImporter importer;
    OpenMesh::IO::Options options(OpenMesh::IO::Options::VertexColor |
                                  OpenMesh::IO::Options::VertexNormal);
    omerr().disable();  // its messages name no file; ours below do
    const bool read = OpenMesh::IO::OMReader().read(stream, importer, options);
    omerr().enable();
    if (!read || importer.n_vertices() != counts.vertices || importer.n_faces() != counts.faces ||
        !importer.finishFaces()) {
        throwFileError(
            path,
            fmt::format("damaged: {} vertices and {} faces could be read, expected {} and {}",
                        importer.n_vertices(), importer.n_faces(), counts.vertices, counts.faces));
    }
    importer.finishColors();
    if (counts.hasTexcoords)
        importer.mesh.remarks["vertices whose texture coordinates are left out"] = counts.vertices;
    if (counts.hasFaceColors)
        importer.mesh.remarks["faces whose colours are left out"] = counts.faces;
    return std::move(importer.mesh);
}

RawMesh readMeshFile(const std::filesystem::path& path, References references,
                     std::optional<double> stillAt) {
    if (isGltf(path)) return readGltf(path, references, stillAt);
    const std::string extension = lowerExtension(path);
    if (extension == ".obj") return readObj(path, references);
    std::string known;
    for (const MeshFormat& format : kFormats) {
        if (extension == format.extension) return format.read(path);
        known += std::string(known.empty() ? "" : ", ") + format.extension;
    }
    requireReadableFile(path);
    throwFileError(path, "extension '" + extension + "', expected one of " + known);
}

}  // namespace shadowcache
