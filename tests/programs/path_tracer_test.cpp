// The example path tracer, which lights with a cache in its own loop, against shadowcache-render.

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include "common/image/exr.h"
#include "tests/support/cli_fixture.h"
#include "tests/support/statistics.h"

namespace shadowcache::test {
namespace {

constexpr int kFrames = 20;
constexpr std::size_t kSize = 32, kTiles = 4;
/// Green of the picture as a whole, and of its tiles.
constexpr std::size_t kMeans = 1 + kTiles * kTiles;

/// By mean, of each frame.
using Means = std::array<std::vector<double>, kMeans>;

void addMeans(Means& means, const std::function<double(std::size_t, std::size_t)>& greenAt) {
    std::array<double, kMeans> sums{};
    for (std::size_t y = 0; y < kSize; ++y)
        for (std::size_t x = 0; x < kSize; ++x) {
            const std::size_t tile = y * kTiles / kSize * kTiles + x * kTiles / kSize;
            sums[0] += greenAt(x, y);
            sums[1 + tile] += greenAt(x, y);
        }
    for (std::size_t k = 0; k < kMeans; ++k) means[k].push_back(sums[k]);
}

double leastPValue(const Means& a, const Means& b) {
    double least = 1;
    for (std::size_t k = 0; k < kMeans; ++k) least = std::min(least, sameMeanPValue(a[k], b[k]));
    return least;
}

/// A floor under a bright and a dim sky, half of it in a shed that light enters by bouncing.
class PathTracer : public CliTest {
protected:
    PathTracer() {
        folder_.write("set.obj",
                      "v -2 0 -2\nv 2 0 -2\nv 2 0 2\nv -2 0 2\nv -2 1 -2\nv 0 1 -2\nv 0 1 2\n"
                      "v -2 1 2\nf 1 4 3 2\nf 5 8 7 6\nf 1 5 8 4\nf 1 2 6 5\n");
        // From (3, 2, 4) to (0, 0.3, 0).
        std::string frames = R"({"origin": [3, 2, 4], "forward": [-3, -1.7, -4], "up": [0, 1, 0]})";
        for (int frame = 1; frame < kFrames; ++frame)
            frames += R"(,{"origin": [3, 2, 4], "forward": [-3, -1.7, -4], "up": [0, 1, 0]})";
        folder_.write(
            "still.json",
            R"({"cam": {"yfov": 0.7853981633974483, "fps": 12, "frames": [)" + frames + "]}}");
        bake();
    }

    Means rendered() const {
        runWell("render", fmt::format("set.obj --env map.exr --cache set.vdb --camera still.json "
                                      "--frames 1-{} --size {}x{} --filter box --camera-rays 4 "
                                      "--samples 1 --bounces 3 -o out.####.exr --progress none",
                                      kFrames, kSize, kSize));
        Means means;
        for (int frame = 1; frame <= kFrames; ++frame) {
            const ExrFile exr = readExr(path(fmt::format("out.{:04}.exr", frame)));
            const auto green = std::ranges::find(exr.channels, "G", &Channel::name);
            addMeans(means, [&](std::size_t x, std::size_t y) {
                return static_cast<double>(green->values[y * kSize + x]);
            });
        }
        return means;
    }

    Means traced(const std::string& options) const {
        Means means;
        for (int frame = 1; frame <= kFrames; ++frame) {
            runWell("path-tracer",
                    fmt::format("set.obj set.vdb map.exr mine.pfm eye=3,2,4 target=0,0.3,0 "
                                "fov=45 size={},{} spp=4 bounces=3 seed={} {}",
                                kSize, kSize, frame, options));
            const std::string bytes = readBytes(path("mine.pfm"));
            std::vector<float> values(3 * kSize * kSize);
            const std::size_t size = sizeof(float) * values.size();
            std::memcpy(values.data(), bytes.data() + (bytes.size() - size), size);
            addMeans(means, [&](std::size_t x, std::size_t y) {
                return static_cast<double>(values[3 * ((kSize - 1 - y) * kSize + x) + 1]);
            });
        }
        return means;
    }
};

// With its control: surfaces that reflect four per cent more.
TEST_F(PathTracer, MakesThePicturesOfTheRenderer) {
    const double level = significance(kMeans);
    const Means truth = rendered();
    EXPECT_GT(leastPValue(traced("albedo=0.5"), truth), level);
    EXPECT_LT(leastPValue(traced("albedo=0.52"), truth), level);
}

}  // namespace
}  // namespace shadowcache::test
