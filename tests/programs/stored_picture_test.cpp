// Pictures of the bundled courtyard, rendered by the programs as they are, against pictures stored
// in tests/stored: whatever changes in years, the mean light stays. Each estimator renders one view
// 32 times with other random numbers.

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <array>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/image/exr.h"
#include "tests/support/program_run.h"
#include "tests/support/statistics.h"
#include "tests/support/temporary_folder.h"

namespace shadowcache::test {
namespace {

constexpr int kFrames = 32;
// A picture is compared as a whole, by colour, and in six parts.
constexpr int kColumns = 3, kRows = 2;
constexpr std::size_t kMeans = 3 + kColumns * kRows;
using Means = std::array<double, kMeans>;

/// Means of the colours of a picture, and of the grey of its parts.
Means meansOf(const std::filesystem::path& path) {
    const ExrFile exr = readExr(path);
    Means means{};
    for (const Channel& channel : exr.channels) {
        const std::size_t color = std::string("RGB").find(channel.name);
        if (color == std::string::npos) continue;
        for (int y = 0; y < exr.height; ++y)
            for (int x = 0; x < exr.width; ++x) {
                const double value = static_cast<double>(
                    channel.values[static_cast<std::size_t>(y * exr.width + x)]);
                const int part = y * kRows / exr.height * kColumns + x * kColumns / exr.width;
                const double pixels = exr.width * exr.height;
                means[color] += value / pixels;
                means[static_cast<std::size_t>(3 + part)] += value * kColumns * kRows / 3 / pixels;
            }
    }
    return means;
}

/// An estimator as it is typed, and how much more light its pictures must tell from the stored one.
struct Way {
    const char *name, *arguments;
    double planted;
};

class StoredPictures : public testing::Test {
protected:
    /// The set and a camera that stands still in one frame of the bundled walk.
    void standAt(int frame) {
        runWell("make-set", "courtyard -o set.ply --camera walk.json");
        nlohmann::json camera = nlohmann::json::parse(readBytes(folder_.path() / "walk.json"));
        nlohmann::json& frames = camera["cam"]["frames"];
        frames = nlohmann::json::array_t(kFrames, frames[static_cast<std::size_t>(frame - 1)]);
        folder_.write("still.json", camera.dump());
    }
    void bake() const {
        runWell(
            "bake",
            "set.ply -o set.vdb --spacing 2 --level 3 --rays 4 --camera still.json --size 48x27");
    }

    void runWell(const std::string& program, const std::string& arguments) const {
        const ProgramRun run = runProgram(program, words(arguments), folder_.path());
        ASSERT_EQ(run.status, 0) << arguments << '\n' << run.err;
    }

    /// The least p-value that pictures by the way have the stored picture's means times `factor`.
    static double pValue(const std::array<std::vector<double>, kMeans>& found, const Means& truth,
                         double factor) {
        double least = 1;
        for (std::size_t k = 0; k < kMeans; ++k)
            least = std::min(least, meanPValue(found[k], truth[k] * factor));
        return least;
    }

    std::array<std::vector<double>, kMeans> render(const Way& way,
                                                   const std::string& arguments) const {
        runWell("render",
                fmt::format(
                    "set.ply --camera still.json --frames 1-{} --size 48x27 -o out.####.exr {} {}",
                    kFrames, arguments, way.arguments));
        std::array<std::vector<double>, kMeans> found;
        for (int frame = 1; frame <= kFrames; ++frame) {
            const std::string number = std::to_string(10000 + frame).substr(1);
            const Means means = meansOf(folder_.path() / ("out." + number + ".exr"));
            for (std::size_t k = 0; k < kMeans; ++k) found[k].push_back(means[k]);
        }
        return found;
    }

    /// Compares pictures by each way with a stored one; more light must be seen.
    void compare(const std::string& picture, const std::vector<Way>& ways,
                 const std::string& arguments, double level) const {
        const Means truth = meansOf(std::filesystem::path(SHADOWCACHE_STORED) / (picture + ".exr"));
        for (const Way& way : ways) {
            SCOPED_TRACE(way.name);
            const auto found = render(way, arguments);
            if (HasFatalFailure()) return;
            EXPECT_GT(pValue(found, truth, 1), level);
            // Control: the stored picture with more light.
            EXPECT_LT(pValue(found, truth, 1 + way.planted), level);
        }
    }

    TemporaryFolder folder_;
};

const std::string kCourtyard =
    "--env " SHADOWCACHE_MAPS "/courtyard.exr --env-rotate 90 --progress none";

TEST_F(StoredPictures, AreThoseOfEstimatorsWithoutCache) {
    const double level = significance(5 * kMeans);
    standAt(1);
    compare("courtyard",
            {{"uniform", "--estimator uniform --spp 64", 0.06},
             {"cosine", "--estimator cosine --spp 64", 0.06},
             {"environment", "--estimator environment --spp 64", 0.02},
             {"mis, the default without a cache", "--spp 64", 0.03},
             {"dome", "--estimator dome --spp 64", 0.02}},
            kCourtyard, level);
}

TEST_F(StoredPictures, AreThoseOfThePapersEstimator) {
    const double level = significance(kMeans);
    standAt(1);
    bake();
    compare("courtyard", {{"paper", "--estimator paper --camera-rays 8 --samples 4", 0.04}},
            kCourtyard + " --cache set.vdb", level);
}

TEST_F(StoredPictures, AreThoseOfTheCache) {
    const double level = significance(kMeans);
    standAt(1);
    bake();
    compare("courtyard", {{"cache, the default", "--spp 64", 0.01}},
            kCourtyard + " --cache set.vdb", level);
}

TEST_F(StoredPictures, OfGlossyWallsAreThoseOfTheCache) {
    const double level = significance(2 * kMeans);
    standAt(20);
    bake();
    compare("gloss", {{"cache", "--spp 64 --cache set.vdb", 0.02}, {"mis", "--spp 64", 0.03}},
            "--env " SHADOWCACHE_MAPS
            "/interior.exr --env-rotate 30 --material roughness=0.3,metallic=0.5 --progress none",
            level);
}

/// Control: light that is turned by 20 degrees is seen.
TEST_F(StoredPictures, AreNotThoseOfOtherLight) {
    standAt(1);
    const Means truth = meansOf(SHADOWCACHE_STORED "/courtyard.exr");
    const auto found = render({"turned", "--spp 64 --env-rotate 110", 0}, kCourtyard);
    EXPECT_LT(pValue(found, truth, 1), significance(kMeans));
}

}  // namespace
}  // namespace shadowcache::test
