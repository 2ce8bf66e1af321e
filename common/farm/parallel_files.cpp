#include <fmt/core.h>

#include "common/farm/farm_files.h"
#include "common/farm/shell.h"

namespace shadowcache {

std::vector<FarmFile> parallelFiles(const FarmPlan& plan) {
    std::string text =
        "#!/usr/bin/env bash\n"
        "# Runs the job with GNU parallel. Options go to every call, as in:\n"
        "#   submit --jobs 4\n"
        "#   submit --sshlogin node1,node2 --retries 3\n"
        "set -euo pipefail\n"
        "cd " +
        shellWord(plan.folder.string()) +
        "\n"
        "# Braces in a path would be replaced in a command of parallel's.\n"
        "export SHADOWCACHE_RUN=" +
        shellWord((plan.folder / "run").string()) +
        "\n"
        "step() { # STEP TASKS OPTIONS...\n"
        "    local step=$1 tasks=$2\n"
        "    shift 2\n"
        "    seq \"$tasks\" | parallel --will-cite --jobs 1 --halt soon,fail=1 --line-buffer \\\n"
        "        --joblog \"log/$step.joblog\" --env SHADOWCACHE_RUN \"$@\" \\\n"
        "        '\"$SHADOWCACHE_RUN\"' again \"$step\" {}\n"
        "}\n";
    for (const FarmStep& step : plan.steps)
        text += fmt::format("step {} {} \"$@\"\n", step.name, step.values.size());
    return {{"submit", text, true}};
}

}  // namespace shadowcache
