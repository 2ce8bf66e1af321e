#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <vector>

#include "bake/core/merge.h"
#include "bake/core/merge_order.h"
#include "common/base/atomic_file.h"
#include "common/base/exit_status.h"
#include "common/base/interrupt.h"
#include "common/base/leftovers.h"
#include "common/base/option_checks.h"
#include "common/base/report_failure.h"
#include "common/base/run_rows.h"
#include "common/cli/command_line.h"

int main(int argc, char** argv) try {
    using namespace shadowcache;
    installFailureHandler();
    CLI::App app("Merges several bakes of one set into one cache.", "shadowcache-merge");
    std::vector<std::filesystem::path> inputs;
    std::filesystem::path output;
    beginCommandLine(app);
    app.add_option("CACHE", inputs,
                   "Caches of one set: the shards of one bake, bakes for several shots, or with "
                   "other seeds; all of these at once and in any order, too")
        ->required()
        ->take_all();
    app.add_option("-o,--output", output, "Cache to write (OpenVDB, .vdb)")->required();
    std::vector<OptionRow> rows{progressRow()};
    rows[0].group = "Options";
    app.footer(
        "All caches must have the same set, spacing, direction level and kind of refinement.\n"
        "The same shard twice is refused; shards that are missing are named. The caches are read\n"
        "one after the other: memory is needed for the sum, not for all of them.\n\n"
        "Examples:\n"
        "  shadowcache-merge part*.vdb -o set.vdb\n"
        "  shadowcache-merge seed1.vdb seed2.vdb -o better.vdb");
    if (const auto status = parseCommandLine(app, argc, argv, rows)) return *status;
    requireExtension(output, ".vdb");
    requireWritable(output);
    installInterruptHandler();
    reportLeftovers(output);
    CacheHeader header;
    const CacheItems items = mergeCaches(inputs, header);
    throwIfInterrupted();
    const auto bytes = writeCache(output, header, items);
    std::printf("%zu caches, %zu items, %.1f MB -> %s\n", inputs.size(), items.size(),
                static_cast<double>(bytes) * 1e-6, output.c_str());
    const std::string missing = missingText(header);
    if (!missing.empty())
        std::printf("not whole: without %s\n", missing.c_str());
    else if (header.part)
        std::printf("whole for its shots: %s\n", header.part->shots.c_str());
    else
        std::printf("whole: no shard is missing\n");
    return kDone;
} catch (const std::exception& e) {
    return shadowcache::reportFailure("shadowcache-merge", e);
}
