// Pictures of `--serve` have the bits of the program's, AOVs included, whatever was rendered
// before, with a target error too; refusals name their cause, and the process goes on; the end
// of the input ends it.

#include <gtest/gtest.h>

#include <bit>
#include <cstring>
#include <nlohmann/json.hpp>
#include <sstream>

#include "common/base/file_bytes.h"
#include "render/serve/pixel_file.h"
#include "tests/support/cli_fixture.h"

namespace shadowcache::test {
namespace {

using Json = nlohmann::json;

/// Replies, by line.
std::vector<Json> repliesIn(const std::string& text) {
    std::vector<Json> replies;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) replies.push_back(Json::parse(line));
    return replies;
}

class ServeTest : public CliTest {
protected:
    /// Replies to requests, of a process that ends well and says nothing else.
    std::vector<Json> ask(const std::string& requests) const {
        folder_.write("requests.jsonl", requests);
        RunLimits limits;
        limits.input = path("requests.jsonl");
        limits.standardBounces = true;
        const ProgramRun result = run("render", "--serve", limits);
        EXPECT_EQ(result.status, 0);
        EXPECT_EQ(result.err, "");
        return repliesIn(result.out);
    }

    /// The last reply to a request.
    static Json reply(const std::vector<Json>& replies, int number) {
        Json last;
        for (const Json& line : replies)
            if (line["id"] == number) last = line;
        return last;
    }

    /// A file of pixels is the EXR that the program writes, bit for bit.
    void expectSame(const std::string& pixels, const Json& done, const std::string& exr) const {
        ASSERT_EQ(done["reply"], "done") << done;
        const ExrFile wanted = readExr(path(exr));
        const std::string bytes = readFileBytes(path(pixels));
        PixelHeader header;
        ASSERT_GE(bytes.size(), sizeof header);
        std::memcpy(&header, bytes.data(), sizeof header);
        EXPECT_EQ(header.sequence, done["sequence"].get<std::uint64_t>());
        EXPECT_EQ(header.request, done["id"].get<std::uint64_t>());
        EXPECT_EQ(static_cast<int>(header.width), wanted.width);
        EXPECT_EQ(static_cast<int>(header.height), wanted.height);
        ASSERT_EQ(header.planes, done["planes"].size());
        ASSERT_EQ(header.planes, wanted.channels.size());
        const std::size_t size = std::size_t{header.width} * header.height;
        for (const Channel& channel : wanted.channels) {
            std::size_t plane = 0;
            while (plane < header.planes && done["planes"][plane] != channel.name) ++plane;
            ASSERT_LT(plane, header.planes) << channel.name;
            std::vector<float> values(size);
            ASSERT_GE(bytes.size(), header.headerBytes + (plane + 1) * size * sizeof(float));
            std::memcpy(values.data(), bytes.data() + header.headerBytes + plane * size * 4,
                        size * sizeof(float));
            std::size_t different = 0;
            for (std::size_t i = 0; i < size; ++i)
                different += std::bit_cast<std::uint32_t>(values[i]) !=
                                     std::bit_cast<std::uint32_t>(channel.values[i])
                                 ? 1
                                 : 0;
            EXPECT_EQ(different, 0u) << channel.name;
        }
    }
};

TEST_F(ServeTest, PicturesHaveTheBitsOfTheProgram) {
    bake();
    const std::string aovs = "--aov irradiance,normal,depth,position,variance,openness ";
    const std::string view = "set.obj --cache set.vdb --size 24x16 ";
    runWell("render", view + aovs +
                          "--env map.exr --env-rotate 30 --env-gain 2,1,0.5 --bounces 4 --spp 6 "
                          "--eye 1,1.5,2 --look-at 0,0.3,0 -o still.exr");
    runWell("render", view +
                          "--env map.exr --env-rotate 10,20,30 --bounces 0 --camera-rays 2 "
                          "--samples 3 --seed 7 --camera camera.json --frames 3 --crop 5,2,11x9 "
                          "--albedo 0.2,0.5,0.9 --material roughness=0.4 -o part.####.exr");
    runWell("render", view + "--env 1,2,3 --preview --spp 0 --camera camera.json -o plain.exr");
    const std::vector<Json> replies = ask(
        R"({"id":1,"request":"load","set":["set.obj"],"cache":"set.vdb"}
{"id":2,"request":"environment","map":"map.exr","rotate":30,"gain":[2,1,0.5]}
{"id":3,"request":"camera","eye":[1,1.5,2],"look-at":[0,0.3,0]}
{"id":4,"request":"size","width":24,"height":16}
{"id":5,"request":"options","spp":6,"bounces":4,"aov":["irradiance","normal","depth","position","variance","openness"]}
{"id":6,"request":"render","pixels":"still"}
{"id":7,"request":"environment","map":"map.exr","rotate":[10,20,30]}
{"id":8,"request":"camera","name":"camera.json"}
{"id":9,"request":"region","x":5,"y":2,"width":11,"height":9}
{"id":10,"request":"options","camera-rays":2,"samples":3,"bounces":0,"seed":7,"albedo":[0.2,0.5,0.9],"material":{"roughness":0.4}}
{"id":11,"request":"render","frame":3,"pixels":"part"}
{"id":12,"request":"environment","radiance":[1,2,3]}
{"id":13,"request":"region"}
{"id":14,"request":"options","preview":true,"spp":0,"bounces":0}
{"id":15,"request":"render","pixels":"plain"}
{"id":16,"request":"environment","map":"map.exr","rotate":30,"gain":[2,1,0.5]}
{"id":17,"request":"camera","eye":[1,1.5,2],"look-at":[0,0.3,0]}
{"id":18,"request":"options","spp":6,"bounces":4,"aov":["irradiance","normal","depth","position","variance","openness"]}
{"id":19,"request":"render","pixels":"again"}
{"id":20,"request":"quit"}
)");
    expectSame("still", reply(replies, 6), "still.exr");
    expectSame("part", reply(replies, 11), "part.0003.exr");
    expectSame("plain", reply(replies, 15), "plain.exr");
    expectSame("again", reply(replies, 19), "still.exr");
    EXPECT_EQ(reply(replies, 20)["reply"], "done");
    EXPECT_EQ(reply(replies, 11)["bias"], "none");
    EXPECT_NE(reply(replies, 15)["bias"], "none");
}

TEST_F(ServeTest, PassesAreShownAndEndWithTheBitsOfTheProgram) {
    bake();
    runWell("render",
            "set.obj --cache set.vdb --size 24x16 --env map.exr --bounces 0 --camera-rays 7 "
            "--pass-rays 3 --eye 1,1.5,2 --look-at 0,0.3,0 -o still.exr");
    const std::vector<Json> replies = ask(
        R"({"id":1,"request":"load","set":["set.obj"],"cache":"set.vdb"}
{"id":2,"request":"environment","map":"map.exr"}
{"id":3,"request":"camera","eye":[1,1.5,2],"look-at":[0,0.3,0]}
{"id":4,"request":"size","width":24,"height":16}
{"id":5,"request":"options","camera-rays":7,"pass-rays":3,"bounces":0}
{"id":6,"request":"render","pixels":"still","progressive":true}
{"id":7,"request":"quit"}
)");
    expectSame("still", reply(replies, 6), "still.exr");
    std::vector<int> rays;
    for (const Json& line : replies)
        if (line["id"] == 6 && line["reply"] == "picture") rays.push_back(line["rays"]);
    EXPECT_EQ(rays, (std::vector<int>{3, 6}));
}

TEST_F(ServeTest, ATargetErrorHasTheBitsOfTheProgram) {
    bake();
    runWell("render",
            "set.obj --cache set.vdb --size 24x16 --env map.exr --bounces 0 --target-error 0.01 "
            "--pass-rays 3 --eye 1,1.5,2 --look-at 0,0.3,0 -o still.exr");
    runWell("render",
            "set.obj --cache set.vdb --size 24x16 --env map.exr --bounces 2 --target-error 0.02 "
            "--samples 2 --eye 1,1.5,2 --look-at 0,0.3,0 -o more.exr");
    const std::vector<Json> replies = ask(
        R"({"id":1,"request":"load","set":["set.obj"],"cache":"set.vdb"}
{"id":2,"request":"environment","map":"map.exr"}
{"id":3,"request":"camera","eye":[1,1.5,2],"look-at":[0,0.3,0]}
{"id":4,"request":"size","width":24,"height":16}
{"id":5,"request":"options","target-error":0.01,"pass-rays":3,"bounces":0}
{"id":6,"request":"render","pixels":"still","progressive":true}
{"id":7,"request":"options","target-error":0.02,"samples":2,"bounces":2}
{"id":8,"request":"render","pixels":"more"}
{"id":9,"request":"quit"}
)");
    expectSame("still", reply(replies, 6), "still.exr");
    expectSame("more", reply(replies, 8), "more.exr");
}

TEST_F(ServeTest, RefusalsNameTheCauseAndTheProcessGoesOn) {
    const std::vector<std::pair<std::string, std::string>> cases{
        {R"("request":"load","set":["missing.obj"])", "missing.obj: no such file"},
        {R"("request":"load","set":[])", "set is [], expected a file at least"},
        {R"("request":"load","set":["set.obj"],"cache":"missing.vdb")", "missing.vdb"},
        {R"("request":"load","set":["set.obj"],"cahce":"set.vdb")",
         "load: unknown key cahce, did you mean cache?"},
        {R"("request":"render","pixels":"p")", "render: no set"},
        {R"("request":"load","set":["set.obj"])", ""},
        {R"("request":"render","pixels":"p")", "render: no environment"},
        {R"("request":"environment","map":"set.obj")", "set.obj"},
        {R"("request":"environment","map":"map.exr","rotate":[1,0,0,0,1,0,0,0,2])",
         "row 3 has the length 2"},
        {R"("request":"environment","radiance":1)", ""},
        {R"("request":"render","pixels":"p")", "render: no camera"},
        {R"("request":"camera","eye":[1,1,1],"look-at":[0,0,0])", ""},
        {R"("request":"size","width":65536,"height":65536)", "expected at most 268435456 pixels"},
        {R"("request":"size","width":8,"height":4)", ""},
        {R"("request":"region","x":4,"y":0,"width":8,"height":4)", ""},
        {R"("request":"render","pixels":"p")", "crop 4,0,8x4: expected a part of the frame"},
        {R"("request":"region")", ""},
        {R"("request":"options","estimator":"cache")", ""},
        {R"("request":"render","pixels":"p")", "estimator cache requires cache"},
        {R"("request":"options","target-error":0)", "options: target-error 0: expected 1e-14 to"},
        {R"("request":"options","spp":1)", ""},
        {R"("request":"render","pixels":"missing/p")", "missing/p: cannot be written"},
        {R"("request":"render","pixels":"set.obj")", "set.obj: is there and no file of pixels"},
        {R"("request":"options","spp":1,"sequence":"larcher-xor")",
         "expected one of sobol, random"},
        {R"("request":"options","spp":1)", ""},
        {R"("request":"render","pixels":"p")", ""}};
    std::string requests;
    for (std::size_t i = 0; i < cases.size(); ++i)
        requests += "{\"id\":" + std::to_string(i) + "," + cases[i].first + "}\n";
    const std::vector<Json> replies = ask(requests + "{\"id\":99,\"request\":\"quit\"}\n");
    for (std::size_t i = 0; i < cases.size(); ++i) {
        const Json answer = reply(replies, static_cast<int>(i));
        if (cases[i].second.empty())
            EXPECT_EQ(answer["reply"], "done") << cases[i].first << answer;
        else
            EXPECT_NE(answer.value("error", "").find(cases[i].second), std::string::npos)
                << cases[i].first << answer;
    }
    EXPECT_EQ(reply(replies, 99)["reply"], "done");
}

TEST_F(ServeTest, TheEndOfTheInputEndsItAndRemovesPixels) {
    const std::string render =
        R"({"id":1,"request":"load","set":["set.obj"]}
{"id":2,"request":"environment","radiance":1}
{"id":3,"request":"camera","eye":[1,1,1],"look-at":[0,0,0]}
{"id":4,"request":"size","width":65536,"height":4096}
{"id":5,"request":"options","spp":65536}
{"id":6,"request":"render","pixels":"p"}
)";
    const std::vector<Json> replies = ask(render);
    EXPECT_EQ(reply(replies, 6)["reply"], "stopped");
    EXPECT_FALSE(std::filesystem::exists(path("p")));
}

TEST_F(ServeTest, OtherOptionsAreRefused) {
    RunLimits limits;
    limits.standardBounces = true;
    const ProgramRun result = run("render", "--serve set.obj", limits);
    EXPECT_EQ(result.status, kWrongUsage);
    EXPECT_EQ(result.err.rfind("shadowcache-render: --serve excludes SET", 0), 0u) << result.err;
}

}  // namespace
}  // namespace shadowcache::test
