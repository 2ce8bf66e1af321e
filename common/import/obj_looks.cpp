#include "common/import/obj_looks.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "common/base/file_bytes.h"
#include "common/import/obj_material.h"
#include "common/import/obj_texcoords.h"

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

/// Parts of the faces and places of their corners; `materials` by material of `looks.names`, -1
/// for none.
void addParts(const ObjLooks& looks, const std::vector<int>& materials,
              const std::vector<GltfMaterial>& made, RawMesh& mesh) {
    ObjTexcoords texcoords(looks.texcoords, looks.faceTexcoords, mesh);
    std::size_t face = 0, corner = 0;
    for (const ObjRun& run : looks.runs) {
        const ObjCorners corners{face, face + run.faceCount, corner};
        for (; face < corners.endFace; ++face) corner += mesh.faceSizes[face];
        const int material =
            run.material < 0 ? -1 : materials[static_cast<std::size_t>(run.material)];
        mesh.parts.push_back({run.faceCount, material, 0});
        if (material < 0) continue;
        texcoords.place(corners, made[static_cast<std::size_t>(material)]);
    }
    texcoords.finish();
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
        mesh.materials.emplace_back(made.back().material).name = looks.names[i];
        mesh.blended += made.back().material.blends ? 1 : 0;
        for (const std::string& name : made.back().leftOut) ++mesh.leftOut[name];
        if (made.back().clamped) ++mesh.remarks[kClampedMaterials];
        nameIfInvisible(made.back(), mesh.leftOutOf);
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
