// The number of threads changes no bit of a cache or of a picture.

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "bake/core/baker.h"
#include "common/base/parallel.h"
#include "common/image/exr.h"
#include "render/frame/aov_channels.h"
#include "render/frame/integrator.h"
#include "render/table/estimator_table.h"
#include "tests/support/foreign_vdb.h"
#include "tests/support/test_scenes.h"

namespace shadowcache {
namespace {

TriangleMesh courtMesh() {
    TriangleMesh mesh;
    test::addFloor(mesh, 0, -2, 2, -2, 2);
    test::addBox(mesh, {-2, 0, -2}, {2, 1.6f, -1.8f});
    test::addSphere(mesh, {0.4f, 0.6f, 0.2f}, 0.5f, 12);
    return mesh;
}

/// Puts the number of threads back when a test ends.
class Threads : public testing::Test {
protected:
    ~Threads() override { setThreadCount(0); }

    /// What `make` returns with one thread, with two, and with every core.
    template <class Make>
    static auto withThreads(const Make& make) {
        std::vector<decltype(make())> all;
        for (const int threads : {1, 2, 0}) {
            setThreadCount(threads);
            all.push_back(make());
        }
        return all;
    }
};

TEST_F(Threads, ChangeNoBitOfACache) {
    const auto files = withThreads([] {
        const TriangleMesh mesh = courtMesh();
        const Scene scene(mesh);
        BakeOptions options;
        options.spacing = 0.2;
        const BakeResult baked = bake(scene, options);
        const test::TemporaryFolder folder;
        writeCache(folder.path() / "cache.vdb", baked.header, baked.items);
        return test::withoutUuids(test::readBytes(folder.path() / "cache.vdb"));
    });
    EXPECT_GT(files[0].size(), 10000u);
    EXPECT_TRUE(files[0] == files[1]);
    EXPECT_TRUE(files[0] == files[2]);
}

TEST_F(Threads, ChangeNoBitOfAPicture) {
    const TriangleMesh mesh = courtMesh();
    const Scene scene(mesh);
    BakeOptions bakeOptions;
    bakeOptions.spacing = 0.5;
    const test::TestCache cache(bake(scene, bakeOptions));
    const Camera camera = lookAt({1.5, 1.8, 2}, {0, 0.2, 0}, {0, 1, 0}, 0.9);
    RenderOptions options;
    options.width = 50;
    options.height = 30;
    options.samples = 8;
    EstimatorOptions estimatorOptions;
    estimatorOptions.paper.triangles = 320;
    const auto render = [&] {
        const Environment environment = test::environmentOf(test::noiseMap(64, 32, 5), 30);
        const EstimatorContext context{scene, environment, &cache.cache(), {}};
        std::vector<std::vector<Channel>> pictures;
        for (const auto& [name, estimator] : test::everyEstimator(context, estimatorOptions)) {
            RenderStats stats;
            pictures.push_back(
                channels(shadowcache::render({*estimator, camera, 1, options}, stats), aovNames()));
        }
        return pictures;
    };
    const auto runs = withThreads(render);
    // Control: another seed is seen.
    ++options.seed;
    const auto other = render();
    for (std::size_t e = 0; e < other.size(); ++e) {
        const char* name = estimatorTable()[e].name;
        for (std::size_t c = 0; c < other[e].size(); ++c) {
            EXPECT_TRUE(runs[0][e][c].values == runs[1][e][c].values) << name;
            EXPECT_TRUE(runs[0][e][c].values == runs[2][e][c].values) << name;
        }
        EXPECT_FALSE(runs[0][e][0].values == other[e][0].values) << name;
    }
}

}  // namespace
}  // namespace shadowcache
