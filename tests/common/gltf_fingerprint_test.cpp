// What a cache is recognized by, of sets whose triangles differ in their materials.

#include <gtest/gtest.h>

#include <set>

#include "common/import/load_mesh.h"
#include "common/mesh/mesh_fingerprint.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/temporary_folder.h"

namespace shadowcache::test {
namespace {

using Json = nlohmann::json;

std::uint64_t fingerprintOf(const GltfBuilder& file) {
    const TemporaryFolder folder;
    const auto path = folder.write("a.glb", file.glb());
    return fingerprint(loadMesh({&path, 1}, {}));
}

/// Which of two triangles has one side, or a hole, and not only that one has.
TEST(GltfFingerprint, KnowsTheSidesAndHolesOfEachTriangle) {
    GltfBuilder file = squareGltf();
    file.append("materials", {{"doubleSided", true}});
    file.append("materials", Json::object());
    file.append("materials", {{"doubleSided", true}, {"alphaMode", "MASK"}});
    Json& primitives = file.json["meshes"][0]["primitives"];
    primitives.push_back(primitives[0]);
    primitives[0]["indices"] = file.accessor(std::vector<std::uint8_t>{0, 1, 2}, "SCALAR", 1);
    primitives[1]["indices"] = file.accessor(std::vector<std::uint8_t>{0, 2, 3}, "SCALAR", 1);
    file.root({{"mesh", 0}});
    std::set<std::uint64_t> seen;
    for (const int first : {0, 1, 2})
        for (const int second : {0, 1, 2}) {
            primitives[0]["material"] = first;
            primitives[1]["material"] = second;
            seen.insert(fingerprintOf(file));
        }
    EXPECT_EQ(seen.size(), 9u);
    // The order of a triangle's corners says nothing more than its winding, whatever it has.
    primitives[0]["indices"] = file.accessor(std::vector<std::uint8_t>{1, 2, 0}, "SCALAR", 1);
    EXPECT_TRUE(seen.contains(fingerprintOf(file)));
    primitives[0]["indices"] = file.accessor(std::vector<std::uint8_t>{1, 0, 2}, "SCALAR", 1);
    EXPECT_FALSE(seen.contains(fingerprintOf(file)));
    // A material that says nothing is as good as none.
    primitives[1].erase("material");
    primitives[0]["material"] = 0;
    const std::uint64_t without = fingerprintOf(file);
    primitives[1]["material"] = 0;
    EXPECT_EQ(fingerprintOf(file), without);
}

}  // namespace
}  // namespace shadowcache::test
