// Blender as the real exporter of a set and a camera move. Skipped where it is not installed.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <vector>

#include "common/base/error.h"
#include "common/image/exr.h"
#include "common/import/load_mesh.h"
#include "common/import/mesh_options.h"
#include "common/shot/camera_file.h"
#include "common/shot/gltf_shot.h"
#include "tests/support/needs.h"
#include "tests/support/program_run.h"
#include "tests/support/temporary_folder.h"

namespace shadowcache::test {
namespace {

Vec3d vectorOf(const nlohmann::json& list) {
    return {list[0].get<double>(), list[1].get<double>(), list[2].get<double>()};
}

class Blender : public testing::Test {
protected:
    void SetUp() override {
        SHADOWCACHE_NEEDS("Blender (Debian package: blender)", "command -v blender");
    }

    /// Runs Blender with the rest of its command line, in the test's folder.
    void blender(const std::string& line) const {
        const std::string command = "cd " + folder_.path().string() +
                                    " && blender -b --python-exit-code 1 " + line + " > log 2>&1";
        ASSERT_EQ(std::system(command.c_str()), 0) << readBytes(folder_.path() / "log");
    }

    std::filesystem::path path(const char* name) const { return folder_.path() / name; }

    static void expectSame(const Camera& found, const Camera& wanted) {
        EXPECT_LT((found.origin - wanted.origin).length(), 1e-4);
        EXPECT_LT((found.forward - wanted.forward).length(), 1e-4);
        EXPECT_LT((found.up - wanted.up).length(), 1e-4);
        EXPECT_NEAR(found.fovY, wanted.fovY, 1e-4);
    }

    const TemporaryFolder folder_;
};

TEST_F(Blender, ExportedShotIsTheSameHere) {
    blender("--factory-startup --python " SHADOWCACHE_SCENES
            "/blender_shot.py -- set.glb poses.json");
    const std::filesystem::path glb = path("set.glb");
    const auto wanted = nlohmann::json::parse(readBytes(path("poses.json")));
    const GltfShot shot(glb, {}, wanted["fps"].get<double>());
    const NamedCamera camera = findCamera({&shot, 1}, "shot");
    for (const auto& pose : wanted["poses"]) {
        SCOPED_TRACE(pose.dump());
        expectSame(shot.camera(camera.node, pose["frame"].get<int>()),
                   {vectorOf(pose["origin"]), vectorOf(pose["forward"]), vectorOf(pose["up"]),
                    wanted["fov_y"].get<double>()});
    }

    const TriangleMesh mesh = loadMesh({&glb, 1}, {});
    EXPECT_EQ(mesh.report.instances, 80u);
    EXPECT_LT(mesh.triangles.size() * 10, mesh.report.placed);
    const auto run = [&](const std::string& program, const std::string& line) {
        const ProgramRun result = runProgram(program, words(line), folder_.path());
        EXPECT_EQ(result.status, 0) << result.err;
    };
    run("bake", "set.glb -o set.vdb --spacing 0.5 --level 3 --rays 4");
    run("render",
        "set.glb --cache set.vdb --env 1,1,1 --camera shot --frames 1-240x239 --samples 4"
        " --size 32x18 -o f.####.exr");
}

// What export_from_blender.py writes in its two forms is one set and one camera; the picture stands
// upright, because angles of view are given across the longer side.
TEST_F(Blender, BothExportsOfAFileAgree) {
    blender("--factory-startup --python " SHADOWCACHE_SCENES
            "/blender_shot.py --python-expr 'import bpy, os; render = bpy.context.scene.render; "
            "render.resolution_x, render.resolution_y = 540, 960; "
            "bpy.ops.wm.save_as_mainfile(filepath=os.path.abspath(\"shot.blend\"))' -- set.glb "
            "poses.json");
    blender("shot.blend --python " SHADOWCACHE_SCENES "/export_from_blender.py -- whole.glb");
    blender("shot.blend --python " SHADOWCACHE_SCENES
            "/export_from_blender.py -- bare.ply bare.json");
    const GltfShot shot(path("whole.glb"), {}, 24);
    const CameraTrack track = readCameraFile(path("bare.json"));
    ASSERT_EQ(track.frames.size(), 240u);
    const NamedCamera camera = findCamera({&shot, 1}, "shot");
    for (const int frame : {1, 50, 240}) {
        SCOPED_TRACE(frame);
        expectSame(shot.camera(camera.node, frame), cameraAtFrame(track, frame));
    }
    MeshOptions zUp;
    zUp.zUp = true;
    const std::filesystem::path glb = path("whole.glb"), ply = path("bare.ply");
    const TriangleMesh whole = loadMesh({&glb, 1}, {}), bare = loadMesh({&ply, 1}, zUp);
    EXPECT_EQ(whole.report.placed, bare.triangles.size());
    EXPECT_EQ(whole.report.instances, 80u);
    EXPECT_LT((whole.origin - bare.origin).length(), 1e-4);
}

/// Mean alpha of tiles of 4 x 4 pixels.
std::vector<double> tilesOfAlpha(const std::filesystem::path& file) {
    constexpr int kTile = 4;
    const ExrFile picture = readExr(file);
    const auto alpha = std::ranges::find(picture.channels, "A", &Channel::name);
    if (alpha == picture.channels.end()) throw Error(file.string() + " has no alpha");
    const int columns = picture.width / kTile;
    std::vector<double> tiles(static_cast<std::size_t>(columns * (picture.height / kTile)));
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x)
            tiles[static_cast<std::size_t>(y / kTile * columns + x / kTile)] +=
                static_cast<double>(
                    alpha->values[static_cast<std::size_t>(y * picture.width + x)]) /
                (kTile * kTile);
    return tiles;
}

double mostApart(const std::vector<double>& a, const std::vector<double>& b) {
    double most = 0;
    for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, std::abs(a[i] - b[i]));
    return most;
}

// Lens, shift, planes, orthographic views and wide pixels, as the exporter writes them.
TEST_F(Blender, CamerasAreThoseOfCycles) {
    blender("--factory-startup --python " SHADOWCACHE_SCENES "/blender_cameras.py -- .");
    const std::vector<double> plain = tilesOfAlpha(path("plain.exr"));
    for (const std::string name :
         {"plain", "shifted", "orthographic", "wide_pixels", "clipped", "soft", "triangular"}) {
        SCOPED_TRACE(name);
        const ProgramRun result =
            runProgram("render",
                       words("set.ply --up z --env 1,1,1 --camera " + name +
                             ".json --size 96x64 --estimator mis --camera-rays 256 --samples 1 "
                             "--bounces 0 --filter box --transparent -o ours.exr"),
                       folder_.path());
        ASSERT_EQ(result.status, 0) << result.err;
        const std::vector<double> wanted = tilesOfAlpha(folder_.path() / (name + ".exr"));
        // Of 4096 rays a tile, a lens's noise included.
        EXPECT_LT(mostApart(tilesOfAlpha(path("ours.exr")), wanted), 0.02);
        if (name != "plain") {
            EXPECT_GT(mostApart(plain, wanted), 0.1) << "control: the plain camera";
        }
    }
}

}  // namespace
}  // namespace shadowcache::test
