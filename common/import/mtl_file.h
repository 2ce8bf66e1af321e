#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/image/image.h"
#include "common/math/vec.h"

namespace shadowcache {

// A library of materials of Wavefront OBJ files (.mtl), as it stands.

/// A picture that a line names, and how it lies: at (u, v) it is looked up at
/// scale * (u, v) + offset.
struct MtlMap {
    std::string file;  ///< as it stands in the library; may hold blanks
    std::array<float, 2> scale{1, 1};
    std::array<float, 2> offset{0, 0};
    bool clamp = false;  ///< else it repeats
    float strength = 1;  ///< -bm
};

struct MtlMaterial {
    std::string name;
    std::optional<Rgb> diffuse, specular, emission;  ///< Kd, Ks, Ke; as they stand
    std::optional<float> opacity;                    ///< d, or 1 - Tr; 0 to 1
    std::optional<float> transparency;               ///< Tr; 0 to 1
    std::optional<float> exponent;                   ///< Ns, at least 0
    std::optional<float> roughness, metallic;        ///< Pr, Pm; 0 to 1
    int illumination = 2;                            ///< illum
    /// By keyword in lower case, of those in kMtlMaps.
    std::map<std::string, MtlMap, std::less<>> maps;
    bool clamped = false;              ///< a number was out of range or not finite
    std::vector<std::string> leftOut;  ///< lines that mean something and are not read, each once

    /// Lists a line, once.
    void leaveOut(const std::string& line);
    /// The picture of a keyword, or null.
    const MtlMap* map(std::string_view keyword) const;
};

/// Keywords of the pictures that are read.
inline constexpr std::array<std::string_view, 6> kMtlMaps{"map_kd", "map_d",  "map_ke",
                                                          "map_pr", "map_pm", "norm"};

/// Reads a library.
///
/// @throws Error naming the file: binary data
std::vector<MtlMaterial> readMtl(const std::filesystem::path& path);

}  // namespace shadowcache
