#include "tests/benchmarks/programs.h"

#include <fstream>
#include <nlohmann/json.hpp>

#include "common/base/error.h"
#include "tests/support/program_run.h"

namespace shadowcache::bench {

namespace {

void collect(const nlohmann::json& json, const std::string& prefix, Stats& stats) {
    for (const auto& [key, value] : json.items()) {
        if (value.is_object()) collect(value, prefix + key + ".", stats);
        if (value.is_number()) stats[prefix + key] = value.get<double>();
    }
}

}  // namespace

Stats runForStats(const std::string& program, std::vector<std::string> arguments,
                  const std::filesystem::path& folder) {
    const std::filesystem::path file = folder / "stats.json";
    arguments.insert(arguments.end(), {"--stats", file.string()});
    const test::ProgramRun run = test::runProgram(program, arguments, folder);
    if (run.status != 0) throw Error("shadowcache-" + program + " failed: " + run.err);
    std::ifstream in(file);
    Stats stats;
    collect(nlohmann::json::parse(in), "", stats);
    return stats;
}

}  // namespace shadowcache::bench
