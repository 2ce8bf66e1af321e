#pragma once

#include "bake/core/baker.h"
#include "common/base/parallel.h"
#include "render/frame/integrator.h"
#include "render/frame/pilot.h"
#include "render/table/estimator_table.h"
#include "tests/support/test_scenes.h"

namespace shadowcache::test {

/// A plain with boxes on it, within [-1, 1].
inline TriangleMesh plainMesh() {
    TriangleMesh mesh;
    addFloor(mesh, 0, -1, 1, -1, 1);
    for (int i = 0; i < 3; ++i) {
        const float x = -0.7f + 0.55f * static_cast<float>(i);
        addBox(mesh, {x, 0, -0.3f}, {x + 0.2f, 0.25f, 0.1f});
    }
    return mesh;
}

/// "cache.vdb" of that set.
inline std::filesystem::path writePlain(const TemporaryFolder& folder, const BakeOptions& options) {
    const TriangleMesh mesh = plainMesh();
    const BakeResult baked = bake(Scene(mesh), options);
    writeCache(folder.path() / "cache.vdb", baked.header, baked.items);
    return folder.path() / "cache.vdb";
}

/// Puts the number of threads back.
struct ThreadsOf {
    explicit ThreadsOf(int threads) { setThreadCount(threads); }
    ~ThreadsOf() { setThreadCount(0); }
};

/// A small picture of it.
inline Film renderPlain(const ShadowCache& cache, int threads, int samples = 4) {
    const ThreadsOf limit(threads);
    const TriangleMesh mesh = plainMesh();
    const Scene scene(mesh);
    const Environment environment = environmentOf(noiseMap(64, 32, 5), 30);
    const auto estimator = findEstimator("cache").make({scene, environment, &cache});
    const Camera camera = lookAt({0.9, 1.3, 1.6}, {0, 0, 0.1}, {0, 1, 0}, 0.9);
    RenderOptions options;
    options.width = 96;
    options.height = 64;
    options.samples = samples;
    options.insight = true;
    RenderStats stats;
    FrameRequest frame{*estimator, camera, 1, options};
    frame.plan = planFrame(frame, stats);
    return render(frame, stats);
}

}  // namespace shadowcache::test
