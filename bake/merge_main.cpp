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

namespace shadowcache {
namespace {

constexpr const char* kFooter =
    "All caches must have the same set, spacing, direction level and kind of refinement.\n"
    "The same shard twice is refused; shards that are missing are named. The caches are read\n"
    "one after the other: memory is needed for the sum, not for all of them.\n\n"
    "Examples:\n"
    "  shadowcache-merge part*.vdb -o set.vdb\n"
    "  shadowcache-merge seed1.vdb seed2.vdb -o better.vdb";

std::vector<OptionRow> optionRows(std::vector<std::filesystem::path>& inputs,
                                  std::filesystem::path& output) {
    OptionRow caches = ownTextsRow(
        "CACHE",
        [&inputs](std::span<const std::string> texts) {
            inputs.assign(texts.begin(), texts.end());
        },
        "Caches of one set: the shards of one bake, bakes for several shots, or with other seeds; "
        "all of these at once and in any order, too");
    caches.isPositional = true;
    OptionRow out = textRow("output", output, "Cache to write (OpenVDB, .vdb)");
    out.letter = 'o';
    std::vector<OptionRow> rows{caches.required(), out.required(), progressRow()};
    for (OptionRow& row : rows) row.group = "Options";
    return rows;
}

}  // namespace
}  // namespace shadowcache

int main(int argc, char** argv) try {
    using namespace shadowcache;
    installFailureHandler();
    std::vector<std::filesystem::path> inputs;
    std::filesystem::path output;
    const ParsedLine parsed = parseCommandLine(
        {"shadowcache-merge", "Merges several bakes of one set into one cache.", kFooter}, argc,
        argv, optionRows(inputs, output));
    if (parsed.status) return *parsed.status;
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
