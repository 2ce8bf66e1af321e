// Grids for volume tools, proven with the tools themselves, where these are installed.

#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <set>

#include "tests/support/cli_fixture.h"
#include "tests/support/needs.h"

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#include <stb/stb_image.h>

namespace shadowcache::test {
namespace {

class VolumeTools : public CliTest {
protected:
    VolumeTools() {
        bake();
        runWell("info",
                "set.vdb -o grids.vdb --export-grid surface openness density:surface "
                "mean-direction confidence direction=0,1,0 env=map.exr irradiance=map.exr");
    }

    /// Standard output of a command line for the shell that succeeds.
    std::string shell(const std::string& command) const {
        EXPECT_EQ(std::system(("cd '" + folder_.path().string() + "' && HOME=$PWD " + command +
                               " > shell.out 2> shell.err")
                                  .c_str()),
                  0)
            << readBytes(path("shell.err")) << readBytes(path("shell.out"));
        return readBytes(path("shell.out"));
    }

    /// Number of different colours of a picture.
    std::size_t colorsOf(const std::string& name) const {
        int width = 0, height = 0, channels = 0;
        const std::unique_ptr<stbi_uc, decltype(&stbi_image_free)> bytes(
            stbi_load(path(name).c_str(), &width, &height, &channels, 3), stbi_image_free);
        if (!bytes) return 0;
        std::set<int> colors;
        for (int i = 0; i < width * height; ++i)
            colors.insert(bytes.get()[3 * i] << 16 | bytes.get()[3 * i + 1] << 8 |
                          bytes.get()[3 * i + 2]);
        return colors.size();
    }
};

TEST_F(VolumeTools, VdbPrintListsThem) {
    SHADOWCACHE_NEEDS("vdb_print (Debian package: libopenvdb-tools)", "command -v vdb_print");
    const std::string text = shell("vdb_print -l grids.vdb");
    for (const char* part :
         {"Name: openness", "Name: density", "Name: open_direction", "Name: irradiance",
          "class: fog volume", "vector_type: contravariant relative", "Tree_vec3s_5_4_3"})
        EXPECT_NE(text.find(part), std::string::npos) << part << " in:\n" << text;
}

TEST_F(VolumeTools, VdbRenderShowsThem) {
    SHADOWCACHE_NEEDS("vdb_render (Debian package: libopenvdb-tools)", "command -v vdb_render");
    shell(
        "vdb_render grids.vdb a.png -name density -res 48x32 -translate 0,3,5 -lookat 0,0.3,0 "
        "-absorb 1,1,1 -scatter 2,2,2 -step 0.5");
    EXPECT_GT(colorsOf("a.png"), 20u);
}

TEST_F(VolumeTools, PythonReadsThem) {
    // The interpreter that Debian's python3-openvdb belongs to.
    SHADOWCACHE_NEEDS("pyopenvdb (Debian packages: python3-openvdb, python3-numpy)",
                      "/usr/bin/python3 -c 'import numpy, pyopenvdb'");
    folder_.write("read.py", R"(
import pyopenvdb as vdb
grids = {grid.name: grid for grid in vdb.readAll("grids.vdb")[0]}
names = ["confidence", "density", "direction_visibility", "env_visibility", "irradiance",
         "open_direction", "openness", "surface"]
assert sorted(grids) == names, sorted(grids)
for name in names:
    grid = grids[name]
    vector = name in ("irradiance", "open_direction")
    assert grid.valueTypeName == ("vec3s" if vector else "float"), name
    assert grid.gridClass == ("unknown" if vector else "fog volume"), (name, grid.gridClass)
    assert grid.transform.voxelSize()[0] == 0.25
assert grids["open_direction"].vectorType == "contravariant relative"
assert grids["irradiance"].vectorType == "invariant"
# The table's top, at y = 0.6, sees all of the sky.
top = grids["openness"].transform.worldToIndexCellCentered((0, 0.6, 0))
print("top", grids["openness"].getConstAccessor().getValue(top))
)");
    const std::string text = shell("/usr/bin/python3 read.py");
    ASSERT_TRUE(text.starts_with("top ")) << text;
    EXPECT_GT(std::stod(text.substr(4)), 0.95);
}

TEST_F(VolumeTools, BlenderRendersThem) {
    SHADOWCACHE_NEEDS("Blender (Debian package: blender)", "command -v blender");
    const auto render = [&](const std::string& grid) {
        const std::string text = shell(
            "timeout 100 blender -b --factory-startup --python-exit-code 1 -P "
            "'" SHADOWCACHE_SCENES "/volume_picture.py' -- grids.vdb " +
            grid + " \"$PWD/" + grid + ".png\" 32 18 1");
        EXPECT_GT(colorsOf(grid + ".png"), 20u) << grid;
        return text;
    };
    EXPECT_NE(render("openness").find("grid openness FLOAT"), std::string::npos);
    EXPECT_NE(render("open_direction").find("grid open_direction VECTOR_FLOAT"), std::string::npos);
    EXPECT_NE(render("density").find("grid density FLOAT"), std::string::npos);
}

}  // namespace
}  // namespace shadowcache::test
