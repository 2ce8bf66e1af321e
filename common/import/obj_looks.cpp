#include "common/import/obj_looks.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <utility>

#include "common/base/file_bytes.h"
#include "common/import/obj_material.h"

namespace shadowcache {

namespace {

namespace fs = std::filesystem;

/// Calls `take(name, file or nothing)` for the libraries of a line: one whose name has blanks, or
/// several.
template <class Take>
void findLibraries(const fs::path& path, const std::string& line, References references,
                   const Take& take) {
    if (const auto file = namedFile(path, path, line, references)) return take(line, file);
    TextScanner words(path, line, false);
    for (std::string_view word = words.wordOnLine(); !word.empty(); word = words.wordOnLine())
        take(std::string(word), namedFile(path, path, std::string(word), references));
}

/// A material and the library that defines it.
struct Definition {
    fs::path library;
    MtlMaterial material;
};

/// The materials of all libraries by name; the first of a name counts.
std::map<std::string, Definition> readLibraries(const fs::path& path, References references,
                                                const ObjLooks& looks, RawMesh& mesh) {
    std::map<std::string, Definition> found;
    std::set<std::string> lines;
    std::set<fs::path> files;
    for (const std::string& line : looks.libraries) {
        if (!lines.insert(line).second) continue;
        findLibraries(path, line, references, [&](const std::string& name, const auto& file) {
            if (!file) {
                ++mesh.leftOut[name + " (no such file)"];
            } else if (files.insert(*file).second) {
                for (MtlMaterial& m : readMtl(*file)) {
                    const std::string material = m.name;
                    found.try_emplace(material, Definition{*file, std::move(m)});
                }
            }
        });
    }
    return found;
}

/// By material of `looks.names`: whether all vertices of its faces have colours; not those without
/// faces.
std::vector<bool> coloredMaterials(const ObjLooks& looks, const RawMesh& mesh) {
    std::vector<bool> colored(looks.names.size(), true), used(looks.names.size(), false);
    std::size_t face = 0, corner = 0;
    for (const ObjRun& run : looks.runs)
        for (std::size_t i = 0; i < run.faceCount; ++i)
            for (std::uint32_t k = mesh.faceSizes[face++]; k > 0; --k) {
                const std::uint32_t v = mesh.faceVertices[corner++];
                if (run.material < 0) continue;
                const auto m = static_cast<std::size_t>(run.material);
                used[m] = true;
                if (v >= looks.colored.size() || !looks.colored[v]) colored[m] = false;
            }
    for (std::size_t m = 0; m < colored.size(); ++m) colored[m] = colored[m] && used[m];
    return colored;
}

/// Gives the corners of faces their places on pictures, and splits vertices that have several.
class TexcoordPlacer {
public:
    TexcoordPlacer(const ObjLooks& looks, RawMesh& mesh)
        : looks_(looks), mesh_(mesh), uses_(mesh.vertices.size(), kUnused) {}

    /// Of the corners from `first` to before `end`, whose material has these places.
    void place(std::size_t first, std::size_t end, const std::vector<GltfTexturePlace>& places) {
        const auto known = std::ranges::find(kinds_, places);
        const auto kind = static_cast<std::uint32_t>(known - kinds_.begin());
        if (known == kinds_.end()) kinds_.push_back(places);
        for (std::size_t i = first; i < end; ++i) {
            std::uint32_t& vertex = mesh_.faceVertices[i];
            if (vertex >= uses_.size()) continue;
            const Use use{looks_.faceTexcoords[i], kind};
            if (uses_[vertex] == kUnused) {
                uses_[vertex] = use;
                write(vertex, use);
            } else if (uses_[vertex] != use) {
                vertex = copyOf(vertex, use);
            }
        }
    }

    /// Fills up what no face has set.
    void finish() {
        if (mesh_.texcoords.empty()) return;
        mesh_.texcoords.resize(mesh_.vertices.size(), kNone);
        for (auto& more : mesh_.moreTexcoords) more.resize(mesh_.vertices.size(), Vec2f(0.0f));
    }

private:
    /// Number of the texture coordinate, and of the places.
    using Use = std::array<std::uint32_t, 2>;
    static constexpr Use kUnused{kNoVertex, kNoVertex};
    static constexpr Vec3f kNone{0, 0, 1};

    std::uint32_t copyOf(std::uint32_t vertex, const Use& use) {
        const auto number = static_cast<std::uint32_t>(mesh_.vertices.size());
        const auto [copy, isNew] = copies_.try_emplace({vertex, use[0], use[1]}, number);
        if (!isNew) return copy->second;
        mesh_.vertices.push_back(Vec3d(mesh_.vertices[vertex]));
        if (!mesh_.colors.empty()) mesh_.colors.push_back(Rgb(mesh_.colors[vertex]));
        write(number, use);
        return number;
    }

    void write(std::uint32_t vertex, const Use& use) {
        const bool placed = use[0] < looks_.texcoords.size();
        if (!placed)
            ++mesh_.remarks["vertices without texture coordinates, whose material has a picture"];
        const Vec2f uv = placed ? looks_.texcoords[use[0]] : Vec2f(0.0f);
        const Vec3f uv1(uv.x, uv.y, 1);
        const std::vector<GltfTexturePlace>& places = kinds_[use[1]];
        if (vertex >= mesh_.texcoords.size()) mesh_.texcoords.resize(mesh_.vertices.size(), kNone);
        mesh_.texcoords[vertex] = {places[0].toS.dot(uv1), places[0].toT.dot(uv1), 1};
        if (mesh_.moreTexcoords.size() + 1 < places.size())
            mesh_.moreTexcoords.resize(places.size() - 1);
        for (std::size_t layer = 1; layer < places.size(); ++layer) {
            std::vector<Vec2f>& more = mesh_.moreTexcoords[layer - 1];
            if (vertex >= more.size()) more.resize(mesh_.vertices.size(), Vec2f(0.0f));
            more[vertex] = {places[layer].toS.dot(uv1), places[layer].toT.dot(uv1)};
        }
    }

    const ObjLooks& looks_;
    RawMesh& mesh_;
    std::vector<Use> uses_;  ///< by vertex of the file: its first
    std::map<std::array<std::uint32_t, 3>, std::uint32_t> copies_;
    std::vector<std::vector<GltfTexturePlace>> kinds_;
};

/// Parts of the faces and places of their corners; `materials` by material of `looks.names`, -1
/// for none.
void addParts(const ObjLooks& looks, const std::vector<int>& materials,
              const std::vector<GltfMaterial>& made, RawMesh& mesh) {
    TexcoordPlacer placer(looks, mesh);
    std::size_t face = 0, corner = 0;
    for (const ObjRun& run : looks.runs) {
        const std::size_t first = corner;
        for (const std::size_t end = face + run.faceCount; face < end; ++face)
            corner += mesh.faceSizes[face];
        const int material =
            run.material < 0 ? -1 : materials[static_cast<std::size_t>(run.material)];
        mesh.parts.push_back({run.faceCount, material, 0});
        if (material < 0) continue;
        const auto& places = made[static_cast<std::size_t>(material)].places;
        if (!places.empty()) placer.place(first, corner, places);
    }
    placer.finish();
}

}  // namespace

void addObjLooks(const fs::path& path, References references, const ObjLooks& looks,
                 RawMesh& mesh) {
    const std::vector<bool> colored = coloredMaterials(looks, mesh);
    std::vector<bool> used(looks.names.size(), false);
    for (const ObjRun& run : looks.runs)
        if (run.material >= 0 && run.faceCount > 0)
            used[static_cast<std::size_t>(run.material)] = true;
    const auto library = readLibraries(path, references, looks, mesh);
    ObjPictures pictures(path, references, mesh);
    std::vector<int> materials(looks.names.size(), -1);
    std::vector<GltfMaterial> made;
    for (std::size_t i = 0; i < materials.size(); ++i) {
        if (!used[i]) continue;
        const auto found = library.find(looks.names[i]);
        if (found == library.end()) {
            ++mesh.leftOut["definition of " + looks.names[i] + " (in no library)"];
            continue;
        }
        const Definition& from = found->second;
        made.push_back(objMaterial(from.material, from.library, colored[i], pictures));
        materials[i] = static_cast<int>(mesh.materials.size());
        mesh.materials.push_back(made.back().material);
        mesh.blended += made.back().material.blends ? 1 : 0;
        for (const std::string& name : made.back().leftOut) ++mesh.leftOut[name];
        if (made.back().clamped) ++mesh.remarks[kClampedMaterials];
    }
    if (!made.empty()) addParts(looks, materials, made, mesh);
}

std::vector<fs::path> objFiles(const fs::path& path, References references) {
    std::set<fs::path> files;
    // What may not be read is the reader's to say.
    const auto keep = [&](const std::string&, const std::optional<fs::path>& file) {
        if (file && (references == References::anywhere || isBeside(path, *file)))
            files.insert(*file);
    };
    std::string bytes = readFileBytes(path);
    useLineFeeds(bytes);
    for (TextScanner text(path, bytes, true); !text.atEnd(); text.nextLine())
        if (text.wordOnLine() == "mtllib")
            findLibraries(path, std::string(text.restOfLine()), References::anywhere, keep);
    for (const fs::path& library : std::set<fs::path>(files))
        for (const MtlMaterial& material : readMtl(library))
            for (const auto& [keyword, map] : material.maps)
                keep(map.file, namedFile(path, library, map.file, References::anywhere));
    return {files.begin(), files.end()};
}

}  // namespace shadowcache
