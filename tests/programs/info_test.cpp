// shadowcache-info: what it says, draws, exports and reports of a cache.

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <regex>

#include "tests/support/cli_fixture.h"
#include "tests/support/foreign_vdb.h"
#include "tests/support/needs.h"

namespace shadowcache::test {
namespace {

using Json = nlohmann::json;

class Info : public CliTest {
protected:
    void refuses(const std::string& arguments, const std::string& first,
                 const std::string& second = "", const RunLimits& limits = {}) const {
        const auto before = files();
        expectRefusal(run("info", arguments, limits), "info", first, second);
        EXPECT_EQ(files(), before) << arguments;
    }
};

std::uint64_t sumOf(const Json& counts) {
    std::uint64_t sum = 0;
    for (const auto& count : counts) sum += count.get<std::uint64_t>();
    return sum;
}

TEST_F(Info, CountsAddUp) {
    bake("--seed 7");
    const Json info = Json::parse(runWell("info", "set.vdb --json").out);
    EXPECT_EQ(sumOf(info["openness"]), info["items"]);
    // Level 3 has 80 base cells an item, 16 a block.
    const auto cells =
        info["items"].get<std::uint64_t>() * 80 + info["blocks"].get<std::uint64_t>() * 16;
    EXPECT_EQ(sumOf(info["regions"]["by_rays"]), cells);
    const auto counted = info["regions"]["base"].get<std::uint64_t>() +
                         info["regions"]["finer"].get<std::uint64_t>();
    EXPECT_EQ(sumOf(info["regions"]["by_visible_share"]), counted);
    EXPECT_EQ(info["regions"]["by_rays"][0], cells - counted);
    EXPECT_EQ(info["bytes"]["items"]["n"], info["items"].get<std::uint64_t>() * 80);
    const std::string text = runWell("info", "set.vdb").out;
    const std::string print = "fingerprint " + info["fingerprint"].get<std::string>();
    for (const char* part : {"bounds ", print.c_str(), "seeds 7", "of them pure",
                             "by number of rays", "items.n ", "level 3 (adaptive), 16 rays"})
        EXPECT_NE(text.find(part), std::string::npos) << part << " in:\n" << text;
}

TEST_F(Info, TellsOfAPlace) {
    bake();
    // On the table, under it, and off everything.
    const std::string above = runWell("info", "set.vdb --at 0,0.6,0,0,2,0 -o sky.png").out;
    EXPECT_NE(above.find("known          100.0 %"), std::string::npos) << above;
    EXPECT_EQ(readBytes(path("sky.png")).substr(1, 3), "PNG");
    const Json on = Json::parse(runWell("info", "set.vdb --at 0,0.6,0,0,1,0 --json").out);
    const Json under = Json::parse(runWell("info", "set.vdb --at 0,0,0,0,1,0 --json").out);
    EXPECT_GT(on["visible"], 0.99);
    EXPECT_LT(under["visible"], on["visible"].get<double>() - 0.1);
    EXPECT_LT(under["visible_cosine"], under["visible"]) << "the table is overhead";
    EXPECT_GT(on["open_direction"][1], 0.99);
    runWell("info", "set.vdb --at 0,0.6,0,0,1,0 --report place.html");
    EXPECT_NE(readBytes(path("place.html")).find("</html>"), std::string::npos);
    EXPECT_NE(runWell("info", "set.vdb --at 0,9,0,0,1,0").out.find("no items here"),
              std::string::npos);
}

TEST_F(Info, ExportsGrids) {
    bake();
    const auto result = runWell(
        "info", "set.vdb --export-grid openness sun:direction=0,1,0 env=map.exr -o grids.vdb");
    EXPECT_EQ(result.out, "grids openness sun env_visibility -> grids.vdb\n");
    std::vector<std::string> names;
    for (const StockVolume& volume : readVolumesWithStockOpenVdb(path("grids.vdb")))
        names.push_back(volume.name);
    std::sort(names.begin(), names.end());
    EXPECT_EQ(names, (std::vector<std::string>{"env_visibility", "openness", "sun"}));
}

TEST_F(Info, Refuses) {
    bake();
    refuses("set.vdb --export-grid sky -o a.vdb", "sky", "no such grid");
    refuses("set.vdb --export-grid mean-directoin -o a.vdb", "did you mean mean-direction?");
    refuses("set.vdb --export-grid env=none.exr -o a.vdb", "none.exr: no such file");
    refuses("set.vdb --export-grid openness", "requires -o");
    refuses("set.vdb --export-grid openness -o a.png", "a.png", ".vdb");
    refuses("set.vdb --export-grid openness -o set.vdb", "set.vdb", "the cache itself");
    refuses("set.vdb --export-grid openness -o none/a.vdb", "none/a.vdb");
    refuses("set.vdb -o a.vdb", "a.vdb", "--at");
    refuses("set.vdb --report a.txt", "a.txt", ".html");
    for (const std::string other : {"--verify", "--report a.html"})
        EXPECT_EQ(run("info", "set.vdb --json " + other).status, kWrongUsage) << other;
    refuses("set.vdb --report none/a.html", "none/a.html");
    for (const std::string place : {"0,0,0", "0,0,0,0,0,0", "0,0,0,0,1,x", "inf,0,0,0,1,0"})
        refuses("set.vdb --at " + place, "--at " + place, "expected X,Y,Z");
    refuses("set.vdb --at 0,0,0,0,1,0 -o a.vdb", "a.vdb", ".png");
    refuses("set.vdb --export-grid openness -o a.vdb", "a.vdb: cannot be written", "", {100, {}});
    refuses("set.vdb --at 0,0,0,0,1,0 -o a.png", "a.png: cannot be written", "", {100, {}});
    refuses("set.vdb --report a.html", "a.html: cannot be written", "", {100, {}});
}

/// Expects every tag of the page to be closed in order, and returns how often each stands there.
std::map<std::string, int> tagsOf(const std::string& page) {
    static const std::regex tag(R"(<(/?)([a-zA-Z]\w*)((?:\s+[\w-]+="[^"<]*")*)\s*(/?)>)");
    std::map<std::string, int> counts;
    std::vector<std::string> open;
    std::size_t place = page.find('>') + 1;  // behind <!DOCTYPE html>
    for (std::size_t next = 0; (next = page.find('<', place)) != std::string::npos;) {
        // An image's data would overflow the stack of std::regex: its value is skipped.
        std::string text = page.substr(next, page.find('>', next) + 1 - next);
        place = next + text.size();
        const std::size_t data = text.find("data:image/png;base64,");
        if (data != std::string::npos) text.erase(data, text.find('"', data) - data);
        std::smatch match;
        if (!std::regex_match(text, match, tag)) {
            ADD_FAILURE() << "not a tag: " << text.substr(0, 100);
            return counts;
        }
        if (match[1].length()) {
            EXPECT_EQ(open.empty() ? "" : open.back(), match[2]) << text;
            if (!open.empty()) open.pop_back();
        } else {
            ++counts[match[2]];
            if (!match[4].length()) open.push_back(match[2]);
        }
    }
    EXPECT_TRUE(open.empty());
    return counts;
}

TEST_F(Info, ReportIsOneWellFormedPage) {
    bake();
    EXPECT_EQ(runWell("info", "set.vdb --report a&b.html").out, "report -> a&b.html\n");
    const std::string page = readBytes(path("a&b.html"));
    ASSERT_TRUE(page.starts_with("<!DOCTYPE html>"));
    const auto tags = tagsOf(page);
    EXPECT_EQ(tags.at("img"), 9);
    EXPECT_EQ(tags.at("svg"), 4);
    EXPECT_EQ(tags.at("h2"), 4);
    EXPECT_EQ(page.find("http"), std::string::npos) << "needs the net";
    EXPECT_EQ(page.find("<script"), std::string::npos);
    std::size_t sources = 0;
    for (std::size_t at = 0; (at = page.find(" src=\"", at)) != std::string::npos; ++sources, ++at)
        EXPECT_EQ(page.compare(at + 6, 22, "data:image/png;base64,"), 0);
    EXPECT_EQ(sources, 9u);
    const Json info = Json::parse(runWell("info", "set.vdb --json").out);
    EXPECT_NE(page.find(info["fingerprint"].get<std::string>()), std::string::npos);
}

TEST_F(Info, ReportEscapesNames) {
    bake();
    std::filesystem::rename(path("set.vdb"), path("<b>&\".vdb"));
    runWell("info", "<b>&\".vdb --report r.html");
    const std::string page = readBytes(path("r.html"));
    tagsOf(page);
    EXPECT_NE(page.find("&lt;b&gt;&amp;&quot;.vdb"), std::string::npos);
}

/// What a browser makes of the page in `name`, as HTML; empty if there is none.
std::string browserSees(const std::filesystem::path& folder, const std::string& name) {
    const std::string out = (folder / "dom.html").string();
    for (const char* browser : {"chromium", "chromium-browser", "google-chrome"}) {
        if (std::system((std::string("command -v ") + browser + " > /dev/null").c_str()) != 0)
            continue;
        const std::string command = "cd '" + folder.string() + "' && HOME='" + folder.string() +
                                    "' timeout 60 " + browser +
                                    " --headless --no-sandbox --disable-gpu --dump-dom 'file://" +
                                    (folder / name).string() + "' > '" + out + "' 2> /dev/null";
        if (std::system(command.c_str()) != 0) return "the browser failed";
        return readBytes(out);
    }
    return "";
}

TEST_F(Info, ReportShowsInABrowser) {
    SHADOWCACHE_NEEDS(
        "Chromium (Debian package: chromium)",
        "command -v chromium || command -v chromium-browser || command -v google-chrome");
    bake();
    runWell("info", "set.vdb --report r.html");
    // A copy says how many of its pictures could be shown, and how tall its bars are.
    std::string page = readBytes(path("r.html"));
    page.insert(page.find("</body>"),
                "<script>onload=()=>{document.title='pictures '+[...document.images].filter("
                "i=>i.naturalWidth>0).length+' bars '+[...document.querySelectorAll('rect')]"
                ".filter(r=>r.getBoundingClientRect().height>1).length+'.'}</script>");
    folder_.write("probe.html", page);
    const std::string seen = browserSees(folder_.path(), "probe.html");
    const std::size_t title = seen.find("<title>pictures 9 bars ");
    ASSERT_NE(title, std::string::npos) << seen.substr(0, 300);
    EXPECT_GT(std::stoi(seen.substr(title + 23)), 50);
}

}  // namespace
}  // namespace shadowcache::test
