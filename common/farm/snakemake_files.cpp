#include <fmt/core.h>

#include "common/farm/farm_files.h"
#include "common/farm/shell.h"

namespace shadowcache {

namespace {

std::string snakefile(const FarmPlan& plan) {
    const FarmStep& last = plan.steps.back();
    std::string text =
        "# Run by submit, in the job's folder. A task that is done has a mark in done/.\n"
        "\n"
        "rule all:\n"
        "    input: \"done/" +
        last.name + ".1\"\n";
    const FarmStep* before = nullptr;
    for (const FarmStep& step : plan.steps) {
        text += "\nrule " + step.name + ":\n";
        if (before)
            text += fmt::format("    input: expand(\"done/{}.{{task}}\", task=range(1, {}))\n",
                                before->name, before->values.size() + 1);
        text += fmt::format(
            "    output: touch(\"done/{0}.{{task}}\")\n"
            "    log: \"log/{0}.{{task}}.log\"\n"
            "    threads: {1}\n"
            "    shell: \"./run again {0} {{wildcards.task}} > {{log}} 2>&1\"\n",
            step.name, plan.threads > 0 ? std::to_string(plan.threads) : "workflow.cores");
        before = &step;
    }
    return text;
}

}  // namespace

std::vector<FarmFile> snakemakeFiles(const FarmPlan& plan) {
    const std::string submit =
        "#!/usr/bin/env bash\n"
        "# Runs the job with Snakemake. Options go to it, as in:\n"
        "#   submit --cores 8\n"
        "#   submit --cluster 'qsub -V' --jobs 100\n"
        "set -euo pipefail\n"
        "cd " +
        shellWord(plan.folder.string()) +
        "\n"
        "[[ $# -gt 0 ]] || set -- --cores all\n"
        "# Tasks find out themselves what is done; marks would outlast what they stand for.\n"
        "exec snakemake --snakefile Snakefile --forceall --rerun-incomplete \"$@\"\n";
    return {{"Snakefile", snakefile(plan), false}, {"submit", submit, true}};
}

}  // namespace shadowcache
