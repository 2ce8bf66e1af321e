// --preview as a user types it.

#include <gtest/gtest.h>

#include <string>

#include "common/image/exr.h"
#include "tests/support/cli_fixture.h"

namespace shadowcache::test {
namespace {

class PreviewCli : public CliTest {
protected:
    PreviewCli() { bake(); }

    /// Arguments of a still, without samples.
    static std::string view(const std::string& options) {
        return "set.obj --env map.exr --cache set.vdb --eye 1,1.5,2 --look-at 0,0.3,0 --size "
               "48x32 " +
               options;
    }
    ExrFile picture(const std::string& options) const {
        runWell("render", view(options + " -o picture.exr"));
        return readExr(path("picture.exr"));
    }
    static bool same(const ExrFile& a, const ExrFile& b) {
        for (std::size_t c = 0; c < a.channels.size(); ++c)
            if (a.channels[c].values != b.channels[c].values) return false;
        return a.channels.size() == b.channels.size();
    }
};

TEST_F(PreviewCli, ChoosesItsRaysAndSaysThatItIsBiased) {
    const auto run = runWell("render", view("--preview -o a.exr --stats a.json"));
    EXPECT_NE(run.out.find("4 x 1 samples"), std::string::npos) << run.out;
    EXPECT_NE(run.out.find("biased"), std::string::npos) << run.out;
    const ExrFile preview = readExr(path("a.exr"));
    EXPECT_NE(preview.metadata.at("shadowcache:bias").find("filter"), std::string::npos);
    EXPECT_NE(readBytes(path("a.json")).find("filter"), std::string::npos);
    EXPECT_TRUE(same(preview, picture("--preview --camera-rays 4 --samples 1")));
    EXPECT_TRUE(same(preview, picture("--preview --spp 4")));
    EXPECT_FALSE(same(preview, picture("--preview --camera-rays 1")));
    const ExrFile prediction = picture("--preview --spp 0");
    EXPECT_NE(prediction.metadata.at("shadowcache:bias").find("no rays"), std::string::npos);
    EXPECT_TRUE(same(prediction, picture("--preview --camera-rays 1 --samples 0")));
    EXPECT_TRUE(same(prediction, picture("--samples 0")));
    // Control: the estimate of the same rays has noise and no bias.
    const ExrFile estimate = picture("--spp 4");
    EXPECT_EQ(estimate.metadata.at("shadowcache:bias"), "none");
    EXPECT_EQ(preview.metadata.at("shadowcache:camera-rays"), "4");
    EXPECT_EQ(preview.metadata.at("shadowcache:samples"), "1");
    EXPECT_FALSE(same(preview, estimate));
}

TEST_F(PreviewCli, IsNearerToAReferenceThanItsEstimate) {
    runWell("render", view("--camera-rays 32 --samples 64 -o reference.exr --seed 7"));
    const auto error = [&](const std::string& options) {
        const auto run = runWell("render", view(options + " --reference reference.exr -o a.exr"));
        const std::string word = "relMSE ";
        return std::stod(run.out.substr(run.out.find(word) + word.size()));
    };
    const double preview = error("--preview");
    EXPECT_LT(preview, error("--spp 4"));
    EXPECT_LT(preview, error("--preview --camera-rays 4 --samples 0"));
    EXPECT_LT(error("--preview --spp 64"), 0.5 * preview);
}

TEST_F(PreviewCli, WorksWithMemoryMovingThingsAndThreads) {
    const ExrFile preview = picture("--preview");
    EXPECT_TRUE(same(preview, picture("--preview --memory 8M")));
    EXPECT_TRUE(same(preview, picture("--preview --threads 1")));
    EXPECT_TRUE(same(preview, picture("--preview --progressive --pass-rays 4")));
    folder_.write("thing.obj", "v 0.5 0.1 0\nv 0.9 0.1 0\nv 0.7 0.6 0\nf 1 2 3\n");
    EXPECT_FALSE(same(preview, picture("--preview --dynamic thing.obj")));
}

TEST_F(PreviewCli, RefusesWhatItCannotKeep) {
    const auto refuses = [&](const std::string& options, const std::string& word) {
        expectRefusal(run("render", view(options + " -o no.exr")), "render", word);
    };
    refuses("--preview --spp -1", "expected 0 to");
    refuses("--preview --estimator mis", "--estimator cache, found mis");
    // Wrong usage ends with another status.
    for (const char* other : {"--target-error 0.1", "--debug 3,3"}) {
        const auto usage = run("render", view(std::string("--preview ") + other + " -o no.exr"));
        EXPECT_EQ(usage.status, 2) << usage.err;
        EXPECT_NE(usage.err.find("--preview"), std::string::npos) << usage.err;
    }
    EXPECT_FALSE(std::filesystem::exists(path("no.exr")));
}

TEST_F(PreviewCli, ExplainSaysWhatItDoes) {
    const auto run = runWell("render", view("--preview -o a.exr --explain"));
    EXPECT_NE(run.out.find("filtered"), std::string::npos) << run.out;
    EXPECT_EQ(runWell("render", view("--spp 4 -o a.exr --explain")).out.find("filtered"),
              std::string::npos);
    EXPECT_FALSE(std::filesystem::exists(path("a.exr")));
}

}  // namespace
}  // namespace shadowcache::test
