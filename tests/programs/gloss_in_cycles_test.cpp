// Pictures of glossy, textured and smooth things against Blender's Cycles, with the BRDF built from
// nodes. Skipped where Blender is not installed.

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>
#include <vector>

#include "common/image/exr.h"
#include "common/image/radiance.h"
#include "common/import/load_mesh.h"
#include "common/shot/gltf_shot.h"
#include "render/frame/integrator.h"
#include "render/table/estimator_table.h"
#include "tests/support/needs.h"
#include "tests/support/temporary_folder.h"

namespace shadowcache::test {
namespace {

/// A sky without edges, because Cycles is linear between the middles of texels, and four soft
/// lamps.
Image softMap() {
    constexpr int kWidth = 512, kHeight = 256;
    const Vec3d lamps[] = {Vec3d(0.5, 0.6, 0.6), Vec3d(-0.7, 0.3, 0.6), Vec3d(0.2, 0.9, -0.3),
                           Vec3d(-0.3, 0.2, -0.9)};
    Image map{kWidth, kHeight, {}};
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const double polar = kPi * (y + 0.5) / kHeight,
                         longitude = kPi - 2 * kPi * (x + 0.5) / kWidth;
            const Vec3d w(std::sin(polar) * std::sin(longitude), std::cos(polar),
                          std::sin(polar) * std::cos(longitude));
            Vec3d light(0.3 + 0.2 * w.y, 0.3 + 0.25 * w.y, 0.35 + 0.3 * w.y);
            for (std::size_t k = 0; k < std::size(lamps); ++k) {
                const double distance2 = (w - lamps[k].normalized()).length2();
                light += Vec3d(1, 0.9 - 0.1 * static_cast<double>(k), 0.7) *
                         (12 * std::exp(-distance2 / 0.02));
            }
            map.pixels.emplace_back(light);
        }
    return map;
}

void writeMap(const std::filesystem::path& path, const Image& map) {
    std::vector<Channel> channels{{"R", {}}, {"G", {}}, {"B", {}}};
    for (const Rgb& texel : map.pixels)
        for (int c = 0; c < 3; ++c)
            channels[static_cast<std::size_t>(c)].values.push_back(texel[c]);
    writeExr(path, map.width, map.height, channels, {}, PixelType::full);
}

/// The set as Blender exported it, and Cycles' picture of it.
class GlossInCycles : public testing::Test {
protected:
    static constexpr int kTile = 6;

    void SetUp() override {
        SHADOWCACHE_NEEDS("Blender (Debian package: blender)", "command -v blender");
    }

    /// Makes the set, and the picture that is wanted.
    void renderInCycles(int samples, int bounces) {
        const auto& folder = folder_.path();
        writeMap(folder / "sky.exr", map_);
        const std::string script = SHADOWCACHE_SCENES "/blender_gloss.py";
        std::string command = "cd " + folder.string();
        command += " && blender -b --factory-startup --python-exit-code 1 --python " + script;
        command +=
            fmt::format(" -- sky.exr set.glb cycles.exr {} 160 90 {} > log 2>&1", samples, bounces);
        ASSERT_EQ(std::system(command.c_str()), 0) << readBytes(folder / "log");
        wanted_ = readRadiance(folder / "cycles.exr").image;
    }

    Film render(const MeshOptions& options, int bounces = 0) {
        const std::filesystem::path file = folder_.path() / "set.glb";
        const TriangleMesh mesh = loadMesh({&file, 1}, options);
        const Scene scene(mesh);
        const Environment environment(map_, 0, {0.2126f, 0.7152f, 0.0722f});
        const auto estimator = findEstimator("mis").make({scene, environment, nullptr});
        const GltfShot shot(file, {}, 24);
        const Camera camera = shot.camera(findCamera({&shot, 1}, "still").node, 1);
        RenderOptions chosen;
        chosen.width = wanted_.width;
        chosen.height = wanted_.height;
        chosen.filter = FilterKind::box;
        chosen.cameraRays = 16;
        chosen.samples = 8;
        chosen.bounces = bounces;
        RenderStats stats;
        return shadowcache::render({*estimator, camera, 1, chosen}, stats);
    }

    /// How two pictures of the set compare.
    struct Comparison {
        double ratio = 0;      ///< of all light, ours over Cycles'
        double worstTile = 0;  ///< greatest relative difference of a tile, less what noise explains
        int tiles = 0;
    };

    /// Of the tiles that show the set alone.
    Comparison compare(const Film& film) const {
        Comparison result;
        double ours = 0, theirs = 0;
        for (int ty = 0; ty + kTile <= film.height; ty += kTile)
            for (int tx = 0; tx + kTile <= film.width; tx += kTile) {
                double sum = 0, squares = 0, light = 0;
                bool whole = true;
                for (int k = 0; k < kTile * kTile; ++k) {
                    const auto i =
                        static_cast<std::size_t>((ty + k / kTile) * film.width + tx + k % kTile);
                    whole = whole && film.pixels[i].coverage == 1;
                    const auto a = static_cast<double>(luminance(film.pixels[i].color)),
                               b = static_cast<double>(luminance(wanted_.pixels[i]));
                    sum += a - b;
                    squares += (a - b) * (a - b);
                    light += b;
                }
                if (!whole) continue;
                const int count = kTile * kTile;
                const double error = std::sqrt((squares - sum * sum / count) * count / (count - 1));
                ours += light + sum;
                theirs += light;
                ++result.tiles;
                result.worstTile = std::max(result.worstTile, (std::abs(sum) - 4 * error) / light);
            }
        result.ratio = ours / theirs;
        return result;
    }

    const Image map_ = softMap();
    const TemporaryFolder folder_;
    Image wanted_;
};

TEST_F(GlossInCycles, IsTheSamePicture) {
    ASSERT_NO_FATAL_FAILURE(renderInCycles(128, 0));
    MeshOptions options;
    options.shadingNormals = options.gloss = true;
    const Comparison same = compare(render(options));
    EXPECT_GT(same.tiles, 150);
    EXPECT_NEAR(same.ratio, 1, 0.01);
    EXPECT_LT(same.worstTile, 0.03);
    // Controls: without gloss, and without the normals of vertices and maps.
    options.gloss = false;
    EXPECT_GT(compare(render(options)).worstTile, 0.1);
    options.gloss = true;
    options.shadingNormals = false;
    EXPECT_GT(compare(render(options)).worstTile, 0.1);
}

TEST_F(GlossInCycles, HasTheSameLightWithBounces) {
    constexpr int kBounces = 4;
    ASSERT_NO_FATAL_FAILURE(renderInCycles(256, kBounces));
    MeshOptions options;
    options.shadingNormals = options.gloss = true;
    const Comparison same = compare(render(options, kBounces));
    std::printf("light over that of Cycles: %.4f in %d tiles, worst tile off by %.4f\n", same.ratio,
                same.tiles, same.worstTile);
    EXPECT_GT(same.tiles, 150);
    EXPECT_NEAR(same.ratio, 1, 0.005);
    // Control: no bounces.
    EXPECT_LT(compare(render(options, 0)).ratio, 0.95);
}

}  // namespace
}  // namespace shadowcache::test
