// The number of threads changes no bit of a cache or of a picture.

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "bake/baker.h"
#include "common/parallel.h"
#include "render/integrator.h"
#include "tests/foreign_vdb.h"
#include "tests/test_scenes.h"

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
    bakeOptions.spacing = 0.3;
    const test::TestCache cache(bake(scene, bakeOptions));
    const Camera camera = lookAt({1.5, 1.8, 2}, {0, 0.2, 0}, {0, 1, 0}, 0.9);
    RenderOptions options;
    options.width = 72;
    options.height = 40;
    options.samples = 8;
    EstimatorOptions estimatorOptions;
    estimatorOptions.triangles = 320;
    for (const EstimatorEntry& entry : estimatorTable()) {
        const auto pictures = withThreads([&] {
            const Environment environment = test::environmentOf(test::noiseMap(64, 32, 5), 30);
            const EstimatorContext context{scene, environment, &cache.cache(), estimatorOptions};
            const auto estimator = entry.make(context);
            RenderStats stats;
            const Film film = render(*estimator, context, camera, 1, options, stats);
            std::vector<std::vector<float>> values;
            for (const Channel& channel : channels(film, aovNames()))
                values.push_back(channel.values);
            return values;
        });
        EXPECT_TRUE(pictures[0] == pictures[1]) << entry.name;
        EXPECT_TRUE(pictures[0] == pictures[2]) << entry.name;
        // Control: another seed is seen.
        ++options.seed;
        const Environment environment = test::environmentOf(test::noiseMap(64, 32, 5), 30);
        const EstimatorContext context{scene, environment, &cache.cache(), estimatorOptions};
        RenderStats stats;
        const Film other = render(*entry.make(context), context, camera, 1, options, stats);
        EXPECT_FALSE(channels(other, {})[0].values == pictures[0][0]) << entry.name;
    }
}

}  // namespace
}  // namespace shadowcache
