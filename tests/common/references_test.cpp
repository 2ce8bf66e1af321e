// What a glTF file may name: files in its folder and below, and others only where that is allowed.

#include <gtest/gtest.h>

#include "common/base/file_bytes.h"
#include "common/import/load_mesh.h"
#include "common/import/set_files.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/temporary_folder.h"

namespace shadowcache::test {
namespace {

namespace fs = std::filesystem;

/// The set "set/a.gltf", whose buffer is to be named, with copies of it in several places.
class ReferencesTest : public testing::Test {
protected:
    ReferencesTest() {
        square_.root({{"mesh", 0}});
        fs::create_directories(folder_.path() / "set" / "sub");
        for (const char* name : {"outside.bin", "set/inside.bin", "set/sub/deeper.bin"})
            folder_.write(name, square_.data());
        fs::create_symlink("../outside.bin", folder_.path() / "set/out.bin");
        fs::create_symlink("inside.bin", folder_.path() / "set/in.bin");
    }

    fs::path naming(const std::string& uri) const {
        return folder_.write("set/a.gltf", square_.gltf(uri));
    }

    static std::size_t triangles(const fs::path& set, References references) {
        MeshOptions options;
        options.references = references;
        return loadMesh(std::span(&set, 1), options).triangles.size();
    }

    TemporaryFolder folder_;
    GltfBuilder square_ = squareGltf();
};

TEST_F(ReferencesTest, FilesBesideAreRead) {
    for (const char* uri : {"inside.bin", "./inside.bin", "sub/deeper.bin", "sub/../inside.bin",
                            "in.bin", "%69nside.bin"}) {
        SCOPED_TRACE(uri);
        const fs::path set = naming(uri);
        EXPECT_EQ(triangles(set, References::inside), 2u);
        EXPECT_EQ(filesOf(set, References::inside).size(), 2u);
    }
}

TEST_F(ReferencesTest, FilesOutsideOnlyIfAllowed) {
    const std::string absolute = (folder_.path() / "outside.bin").string();
    for (const std::string& uri : {std::string("../outside.bin"), std::string("out.bin"),
                                   std::string("sub/../../outside.bin"), absolute}) {
        SCOPED_TRACE(uri);
        const fs::path set = naming(uri);
        expectError([&] { triangles(set, References::inside); }, set.string(), "--allow-external");
        EXPECT_EQ(filesOf(set, References::inside).size(), 1u);
        EXPECT_EQ(triangles(set, References::anywhere), 2u);
        EXPECT_EQ(filesOf(set, References::anywhere).size(), 2u);
    }
}

/// A name is relative to the set's folder, wherever the program runs.
TEST_F(ReferencesTest, TheCurrentFolderIsNotLookedIn) {
    const fs::path before = fs::current_path();
    fs::current_path(folder_.path());
    const fs::path set = naming("outside.bin");
    expectError([&] { triangles(set, References::anywhere); }, set.string(),
                "outside.bin was not found");
    // A set named without its folder is in the current one.
    fs::current_path(folder_.path() / "set");
    naming("inside.bin");
    EXPECT_EQ(triangles("a.gltf", References::inside), 2u);
    naming("../outside.bin");
    expectError([&] { triangles("a.gltf", References::inside); }, "a.gltf", "--allow-external");
    fs::current_path(before);
}

TEST_F(ReferencesTest, WhatIsNoFileIsNotFound) {
    for (const char* uri : {"none.bin", "http://example.org/a.bin", "file:///dev/zero", "/dev/zero",
                            "$(touch x)", "`touch x`", "sub"}) {
        SCOPED_TRACE(uri);
        const fs::path set = naming(uri);
        for (const References references : {References::inside, References::anywhere})
            expectError([&] { triangles(set, references); }, set.string(), "");
    }
    EXPECT_FALSE(fs::exists(folder_.path() / "set/x"));
    EXPECT_FALSE(fs::exists("x"));
}

}  // namespace
}  // namespace shadowcache::test
