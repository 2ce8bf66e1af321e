#include <fmt/core.h>

#include <cmath>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "bake/core/merge_order.h"
#include "bake/inspect/grid_export.h"
#include "bake/inspect/info_text.h"
#include "bake/inspect/report.h"
#include "common/base/atomic_file.h"
#include "common/base/error.h"
#include "common/base/exit_status.h"
#include "common/base/leftovers.h"
#include "common/base/option_checks.h"
#include "common/base/parallel.h"
#include "common/base/report_failure.h"
#include "common/base/run_rows.h"
#include "common/cli/command_line.h"
#include "common/image/png.h"

namespace shadowcache {
namespace {

struct Arguments {
    std::filesystem::path cache, output, report;
    bool json = false, verify = false;
    std::string place;
    std::vector<std::string> grids;
    double rotation = 0;  ///< of maps about +Y, degrees
    int threads = 0;
};

constexpr const char* kFooter =
    "Examples:\n"
    "  shadowcache-info room.vdb\n"
    "  shadowcache-info room.vdb --json > room.json\n"
    "  shadowcache-info room.vdb --verify\n"
    "  shadowcache-info room.vdb --report room.html\n"
    "  shadowcache-info room.vdb --at 1,0,2,0,1,0 -o sky.png\n"
    "  shadowcache-info room.vdb --export-grid openness mean-direction -o grids.vdb\n"
    "  shadowcache-info room.vdb --export-grid density:direction=0,1,0 -o noon.vdb\n"
    "  shadowcache-info room.vdb --export-grid irradiance=sky.exr --env-rotate 90 -o "
    "light.vdb";

OptionRow grouped(OptionRow row, const char* group) {
    row.group = group;
    return row;
}

OptionRow gridsRow(std::vector<std::string>& grids) {
    std::string kinds;
    for (const std::string& kind : gridKinds()) kinds += (kinds.empty() ? "" : ",") + kind;
    OptionRow row = ownTextsRow(
        "export-grid",
        [&grids](std::span<const std::string> texts) { grids.assign(texts.begin(), texts.end()); },
        "[NAME:]KIND..., written to -o (.vdb). NAME is the grid's name; many tools show `density` "
        "first. KIND is one of" +
            gridKindsHelp());
    row.form = OptionForm::words;
    return row.typed("SPEC:{" + kinds + "}").excluding("at json");
}

std::vector<OptionRow> optionRows(Arguments& a) {
    OptionRow cache = textRow("CACHE", a.cache, "Cache, written by shadowcache-bake");
    cache.isPositional = true;
    OptionRow output = textRow("output", a.output, "File for --at or --export-grid");
    output.letter = 'o';
    const char* const grids = "Grids for volume tools";
    return {grouped(cache.required(), "Options"),
            grouped(flagRow("json", a.json, "Print as JSON"), "Options"),
            grouped(flagRow("verify", a.verify,
                            "Read all of the file and compare it with its checksums; exit status "
                            "1 if it is not whole")
                        .excluding("json"),
                    "Options"),
            grouped(textRow("report", a.report,
                            "Write an HTML page with settings, slices and histograms (.html)")
                        .excluding("json"),
                    "Options"),
            grouped(textRow("at", a.place,
                            "X,Y,Z,NX,NY,NZ: predicted visibility at a place with this normal; "
                            "with -o also as a lat-long picture (.png)"),
                    "A place"),
            grouped(gridsRow(a.grids), grids),
            grouped(numberRow("env-rotate", a.rotation, {-1e6, 1e6},
                              "Rotation of maps about +Y in degrees, counter-clockwise seen from "
                              "above")
                        .needing("export-grid"),
                    grids),
            grouped(output, "Output"),
            grouped(threadsRow(a.threads), "Output")};
}

/// Refuses invalid options before the long work starts.
void validate(const Arguments& a) {
    if (!a.report.empty()) {
        requireExtension(a.report, ".html");
        requireWritable(a.report);
    }
    if (a.output.empty()) {
        if (!a.grids.empty()) throw Error("--export-grid: requires -o FILE.vdb");
        return;
    }
    if (a.grids.empty() && a.place.empty())
        throw Error("--output " + a.output.string() + ": requires --at or --export-grid");
    requireExtension(a.output, a.grids.empty() ? ".png" : ".vdb");
    requireWritable(a.output);
    std::error_code ignored;
    if (std::filesystem::equivalent(a.output, a.cache, ignored))
        throwFileError(a.output, "is the cache itself, expected another file");
}

void print(const std::string& text) {
    std::fputs(text.c_str(), stdout);
    if (std::fflush(stdout) != 0) throw Error("standard output cannot be written");
}

void printPlace(const Arguments& a) {
    Vec3d position, normal;
    char rest = 0;
    if (std::sscanf(a.place.c_str(), "%lf,%lf,%lf,%lf,%lf,%lf%c", &position.x, &position.y,
                    &position.z, &normal.x, &normal.y, &normal.z, &rest) != 6 ||
        !std::isfinite(position.length() + normal.length()) || !(normal.length() > 0))
        throw Error("--at " + a.place + ": expected X,Y,Z,NX,NY,NZ: a position and a normal");
    const ShadowCache cache(a.cache);
    const SkyView view(cache, position, Vec3f(normal.normalized()));
    print(a.json ? skyAsJson(view) : skyAsText(view));
    constexpr int kWidth = 1024;
    if (!a.output.empty()) writePng(a.output, view.picture(kWidth), 0);
}

void printCheck(const Arguments& a) {
    const CacheCheck check = verifyCache(a.cache);
    const std::string missing = missingText(check.header);
    print(fmt::format("{}: whole: {} bytes, {} checksums, {} items{}\n", a.cache.string(),
                      check.bytes, check.checksums, check.items,
                      missing.empty() ? "" : fmt::format(", of a bake without {}", missing)));
}

void writeReport(const Arguments& a, const CacheFacts& facts) {
    writeWhole(a.report, reportPage(a.cache.filename().string(), facts));
    print("report -> " + a.report.string() + "\n");
}

void run(const Arguments& a) {
    std::vector<GridRequest> requests;
    for (const std::string& spec : a.grids) requests.push_back(parseGridRequest(spec));
    validate(a);
    setThreadCount(a.threads);
    if (a.verify) printCheck(a);
    if (!a.place.empty()) printPlace(a);
    const bool told = a.verify || !a.place.empty();
    if (requests.empty() && a.report.empty() && told) return;
    const CacheFacts facts = readFacts(a.cache);
    if (requests.empty() && a.report.empty())
        return print(a.json ? factsAsJson(facts) : factsAsText(facts));
    if (!a.report.empty()) writeReport(a, facts);
    if (requests.empty()) return;
    reportLeftovers(a.output);
    exportGrids(requests, a.rotation, facts.header, facts.items, a.cache, a.output);
    std::string names;
    for (const GridRequest& request : requests) names += " " + request.name;
    print("grids" + names + " -> " + a.output.string() + "\n");
}

}  // namespace
}  // namespace shadowcache

int main(int argc, char** argv) try {
    using namespace shadowcache;
    installFailureHandler();
    Arguments arguments;
    const ParsedLine parsed =
        parseCommandLine({"shadowcache-info", "Inspects a shadow cache.", kFooter}, argc, argv,
                         optionRows(arguments));
    if (parsed.status) return *parsed.status;
    run(arguments);
    return kDone;
} catch (const std::exception& e) {
    return shadowcache::reportFailure("shadowcache-info", e);
}
