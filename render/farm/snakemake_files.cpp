#include <nlohmann/json.hpp>

#include "render/farm/farm_files.h"
#include "render/farm/shell.h"

namespace shadowcache {

namespace {

/// A literal of Python: those of JSON are.
std::string literal(const std::string& text) {
    return nlohmann::json(text).dump(-1, ' ', true);
}

std::string snakefile(const FarmPlan& plan) {
    const FarmStep& last = plan.steps.back();
    std::string text =
        "# Run by submit, in the job's folder. A task that is done has a mark in done/.\n"
        "RUN = " +
        literal((plan.folder / "run").string()) +
        "\n"
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
                "    params: run=RUN\n"
                "    threads: " +
                (plan.threads > 0 ? std::to_string(plan.threads) : "workflow.cores") +
                "\n"
                "    shell: \"{params.run:q} again " +
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
        "exec snakemake --snakefile Snakefile --rerun-incomplete \"$@\"\n";
    return {{"Snakefile", snakefile(plan), false}, {"submit", submit, true}};
}

}  // namespace shadowcache
