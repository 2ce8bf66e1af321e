// Each option at each door: the ends of its range are accepted, what is beyond is refused under the
// name that the door has for it. (Python's door: tests/python/help_test.py.)

#include "render/library/option_table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <set>

#include "render/app/command_line.h"
#include "render/serve/requests.h"
#include "tests/support/test_scenes.h"

namespace shadowcache::test {
namespace {

/// A job of a command line with one more option. @throws Error
RenderJob typed(const std::string& name, const std::string& text) {
    std::vector<std::string> words{
        "shadowcache-render", "set.obj", "--env",        "1,1,1", "-o", "a.exr",
        "--" + name,          text,      "--progressive"};
    const std::vector<std::string> baked{"--camera", "a.json", "--bake", "set.vdb"},
        known{"--eye", "1,1,1", "--look-at", "0,0,0", "--cache", "set.vdb"};
    const bool bakes = findRow(optionTable(), name)->needs == "bake";
    words.insert(words.end(), bakes ? baked.begin() : known.begin(),
                 bakes ? baked.end() : known.end());
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    RenderJob job;
    EXPECT_FALSE(parseArguments(static_cast<int>(arguments.size()), arguments.data(), job)) << name;
    return job;
}

/// The request that has an option, with a value of it. @throws Error
void requested(const OptionRow& row, const std::string& json) {
    std::string kind = "options", beside;
    RenderJob job;
    for (const Part part : {Part::set, Part::cache})
        if (findRow(optionRows(part, job), row.name)) {
            kind = "load";
            beside = ", \"set\": [\"a\"]";
        }
    if (findRow(optionRows(Part::camera, job), row.name)) {
        kind = "camera";
        beside = ", \"eye\": [1, 1, 1], \"look-at\": [0, 0, 0]";
    }
    const Request request = parseRequest("{\"id\": 1, \"request\": \"" + kind + "\"" + beside +
                                         ", \"" + row.nameAt(Door::serve) + "\": " + json + "}");
    if (!request.error.empty()) throw Error(request.error);
}

bool hasRange(const OptionRow& row) {
    return (row.form == OptionForm::whole || row.form == OptionForm::number) &&
           std::isfinite(row.range.most) && row.name != "seed";
}

/// Numbers at both ends of a row's range, and beyond them.
struct Ends {
    std::vector<std::string> inside, outside;
};

Ends endsOf(const OptionRow& row) {
    const auto text = [&](double n) {
        return row.form == OptionForm::whole ? std::to_string(std::llround(n)) : numberText(n);
    };
    const auto [least, most, leastOut, mostOut] = row.range;
    const double step = row.form == OptionForm::whole ? 1 : 0.01 + std::abs(most) * 0.01;
    Ends ends;
    (leastOut ? ends.outside : ends.inside).push_back(text(least));
    (mostOut ? ends.outside : ends.inside).push_back(text(most));
    ends.outside.push_back(text(least - step));
    ends.outside.push_back(text(most + step));
    return ends;
}

void expectEnds(const OptionRow& row, const std::function<void(const std::string&)>& give,
                const std::string& name) {
    const Ends ends = endsOf(row);
    for (const std::string& number : ends.inside) EXPECT_NO_THROW(give(number)) << name << number;
    for (const std::string& number : ends.outside)
        expectError([&] { give(number); }, name, "expected");
}

TEST(OptionTable, TheCommandLineTakesWhatIsInRange) {
    int walked = 0;
    for (const OptionRow& row : optionTable()) {
        // What else they need, or exclude, stands in another test.
        if (!hasRange(row) || !row.isKept || row.name == "set-frame") continue;
        expectEnds(
            row, [&](const std::string& number) { typed(row.name, number); },
            "--" + row.name + " ");
        ++walked;
    }
    EXPECT_GE(walked, 14);
}

TEST(OptionTable, RequestsTakeWhatIsInRange) {
    int walked = 0;
    for (const OptionRow& row : optionTable()) {
        if (!hasRange(row) || !row.isAt(Door::serve) || row.name == "set-frame") continue;
        expectEnds(
            row, [&](const std::string& number) { requested(row, number); },
            row.nameAt(Door::serve) + " ");
        ++walked;
    }
    EXPECT_GE(walked, 9);
}

TEST(OptionTable, RequestsRefuseAnotherForm) {
    for (const OptionRow& row : optionTable()) {
        RenderJob job;
        if (!row.isAt(Door::serve) || findRow(optionRows(Part::light, job), row.name)) continue;
        const bool isText = row.form == OptionForm::text || row.form == OptionForm::word;
        const std::string wrong = isText ? "[1]" : "\"wrong\"";
        expectError([&] { requested(row, wrong); }, row.nameAt(Door::serve) + " is ", "expected");
    }
}

TEST(OptionTable, EveryChoiceIsTaken) {
    for (const OptionRow& row : optionTable()) {
        if (row.name == "progress") continue;  // takes effect in this process
        for (const std::string& choice : row.choices) {
            EXPECT_NO_THROW(typed(row.name, choice));
            if (row.isAt(Door::serve)) {
                EXPECT_NO_THROW(requested(
                    row, row.takesSeveral() ? "[\"" + choice + "\"]" : "\"" + choice + "\""));
            }
        }
        if (!row.choices.empty() && row.isAt(Door::serve))
            expectError([&] { requested(row, row.takesSeveral() ? "[\"x\"]" : "\"x\""); },
                        row.nameAt(Door::serve) + " x", "expected one of");
    }
}

TEST(OptionTable, NamesAreUniqueAtEachDoor) {
    for (const Door door : {Door::commandLine, Door::blender}) {
        std::set<std::string> names;
        for (const OptionRow& row : optionTable())
            if (row.isAt(door)) {
                EXPECT_TRUE(names.insert(row.nameAt(door)).second) << row.name;
            }
    }
}

TEST(OptionTable, StandardsAreReadBackAsThemselves) {
    RenderJob job, none;
    for (const OptionRow& row : optionRows(job))
        if (!row.standard.empty() && row.name != "spp") {
            EXPECT_NO_THROW(row.read(std::vector{row.standard})) << row.name;
        }
    EXPECT_EQ(job.picture.options.filterWidth, none.picture.options.filterWidth);
    EXPECT_EQ(job.picture.options.width, none.picture.options.width);
    EXPECT_EQ(job.picture.options.seed, none.picture.options.seed);
    EXPECT_EQ(job.camera.fovYDegrees, none.camera.fovYDegrees);
    EXPECT_EQ(job.light.rotation, none.light.rotation);
}

TEST(OptionTable, MessagesHaveTheNamesOfTheDoor) {
    const std::string text =
        "--env-rotate 1: expected --stale-ok, not --fov-y or --no-such-option, a--samples";
    EXPECT_EQ(inWordsOf(Door::commandLine, text), text);
    EXPECT_EQ(inWordsOf(Door::serve, text),
              "rotate 1: expected stale-ok, not fov-y or --no-such-option, a--samples");
    EXPECT_EQ(inWordsOf(Door::python, text),
              "rotate 1: expected stale_ok=True, not fov or --no-such-option, a--samples");
}

}  // namespace
}  // namespace shadowcache::test
