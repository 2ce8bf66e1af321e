// Blender as the real exporter of a set and a camera move. Skipped where it is not installed.

#include <gtest/gtest.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "render/gltf_shot.h"
#include "tests/program_run.h"
#include "tests/temporary_folder.h"

namespace shadowcache::test {
namespace {

Vec3d vectorOf(const nlohmann::json& list) {
    return {list[0].get<double>(), list[1].get<double>(), list[2].get<double>()};
}

TEST(Blender, ExportedShotIsTheSameHere) {
    if (std::system("command -v blender >/dev/null 2>&1") != 0)
        GTEST_SKIP() << "Blender is not installed (Debian package: blender)";
    const TemporaryFolder folder;
    const auto glb = folder.path() / "set.glb", poses = folder.path() / "poses.json";
    const std::string command = std::string(
                                    "blender -b --factory-startup --python-exit-code 1 "
                                    "--python " SHADOWCACHE_SCENES "/blender_shot.py -- ") +
                                glb.string() + " " + poses.string() + " > " +
                                (folder.path() / "log").string() + " 2>&1";
    ASSERT_EQ(std::system(command.c_str()), 0) << readBytes(folder.path() / "log");

    const auto wanted = nlohmann::json::parse(readBytes(poses));
    const GltfShot shot(glb, {}, wanted["fps"].get<double>());
    const NamedCamera camera = findCamera({&shot, 1}, "shot");
    for (const auto& pose : wanted["poses"]) {
        const Camera found = shot.camera(camera.node, pose["frame"].get<int>());
        const auto differs = [&](const Vec3d& v, const char* key) {
            return (v - vectorOf(pose[key])).length();
        };
        EXPECT_LT(differs(found.origin, "origin"), 1e-4) << pose;
        EXPECT_LT(differs(found.forward, "forward"), 1e-4) << pose;
        EXPECT_LT(differs(found.up, "up"), 1e-4) << pose;
        EXPECT_NEAR(found.fovY, wanted["fov_y"].get<double>(), 1e-4);
    }

    const TriangleMesh mesh = loadMesh({&glb, 1}, {});
    EXPECT_EQ(mesh.report.instances, 80u);
    EXPECT_LT(mesh.triangles.size() * 10, mesh.report.placed);
    const auto run = [&](const std::string& program, const std::string& line) {
        const ProgramRun result = runProgram(program, words(line), folder.path());
        EXPECT_EQ(result.status, 0) << result.err;
    };
    run("bake", "set.glb -o set.vdb --spacing 0.5 --level 3 --rays 4");
    run("render",
        "set.glb --cache set.vdb --env 1,1,1 --camera shot --frames 1-240x239 --samples 4"
        " --size 32x18 -o f.####.exr");
}

}  // namespace
}  // namespace shadowcache::test
