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
            text += "    input: expand(\"done/" + before->name + ".{task}\", task=range(1, " +
                    std::to_string(before->values.size() + 1) + "))\n";
        text += "    output: touch(\"done/" + step.name +
                ".{task}\")\n"
                "    log: \"log/" +
                step.name +
                ".{task}.log\"\n"
                "    threads: " +
                (plan.threads > 0 ? std::to_string(plan.threads) : "workflow.cores") +
                "\n"
                "    shell: \"./run again " +
                step.name + " {wildcards.task} > {log} 2>&1\"\n";
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
