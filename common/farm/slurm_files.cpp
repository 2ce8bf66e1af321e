#include <fmt/core.h>

#include "common/farm/farm_files.h"
#include "common/farm/shell.h"

namespace shadowcache {

namespace {

/// What sbatch runs on a node: the task, put back into the queue when it was interrupted.
std::string taskScript(const FarmPlan& plan) {
    return "#!/usr/bin/env bash\n"
           "# One task on a node of Slurm. Interrupted (status 75), it returns to the queue, five\n"
           "# times at most: a time limit that is too short must not go on for ever.\n"
           "set -uo pipefail\n" +
           forwardingSignals() + "attempt " + shellWord((plan.folder / "run").string()) +
           " \"$1\" \"${SLURM_ARRAY_TASK_ID:-1}\"\n"
           "if [[ $status -eq 75 && ${SLURM_RESTART_COUNT:-0} -lt 5 ]]; then\n"
           "    printf 'interrupted, back to the queue\\n'\n"
           "    id=$SLURM_JOB_ID\n"
           "    [[ -z ${SLURM_ARRAY_JOB_ID-} ]] || id=${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID\n"
           "    # Slurm ends this script as it requeues the job.\n"
           "    scontrol requeue \"$id\" && sleep 60\n"
           "fi\n"
           "exit \"$status\"\n";
}

std::string submitScript(const FarmPlan& plan) {
    const std::string cores =
        plan.threads > 0 ? fmt::format("--cpus-per-task={}", plan.threads) : "--exclusive";
    std::string text =
        "#!/usr/bin/env bash\n"
        "# Submits the job to Slurm. Options go to every sbatch, as in:\n"
        "#   submit --partition=render --time=2:00:00\n"
        "# Prints the numbers of the jobs, one for each step.\n"
        "set -euo pipefail\n"
        "cd " +
        shellWord(plan.folder.string()) +
        "\n"
        "after=()\n"
        "submit() { # STEP OPTIONS...\n"
        "    local step=$1 id\n"
        "    shift\n"
        "    # SIGTERM a minute before the time limit; what cannot run any more is removed.\n"
        "    id=$(sbatch --parsable --job-name=\"shadowcache-$step\" --requeue --open-mode=append "
        "\\\n"
        "        --kill-on-invalid-dep=yes --signal=B:TERM@60 " +
        cores +
        " \\\n"
        "        ${after[@]+\"${after[@]}\"} \"$@\" ./slurm-task \"$step\")\n"
        "    id=${id%%;*}\n"
        "    after=(--dependency=\"afterok:$id\")\n"
        "    printf '%s %s\\n' \"$step\" \"$id\"\n"
        "}\n";
    for (const FarmStep& step : plan.steps) {
        const std::size_t tasks = step.values.size();
        text += fmt::format("submit {0} --output=log/{0}{1} \"$@\"\n", step.name,
                            tasks > 1 ? fmt::format(".%a.log --array=1-{}", tasks) : ".log");
    }
    return text;
}

}  // namespace

std::vector<FarmFile> slurmFiles(const FarmPlan& plan) {
    return {{"slurm-task", taskScript(plan), true}, {"submit", submitScript(plan), true}};
}

}  // namespace shadowcache
