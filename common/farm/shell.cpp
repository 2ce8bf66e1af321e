#include "common/farm/shell.h"

#include <fmt/core.h>

#include "common/base/version.h"

namespace shadowcache {

namespace {

/// The word in a script where $value is the task's.
std::string scriptWord(const FarmWord& word) {
    if (!word.varies) return shellWord(word.text);
    const auto part = [](const std::string& text) { return text.empty() ? "" : shellWord(text); };
    return fmt::format("{}\"$value\"{}", part(word.text), part(word.after));
}

/// Lines that end the script where the task's product is there, and newer than its sources.
std::string skipWhatIsDone(const FarmStep& step) {
    if (step.product.text.empty() && !step.product.varies) return "";
    const std::string product = scriptWord(step.product);
    std::string condition = fmt::format("-f {}", product);
    if (!step.sources.empty()) {
        condition += " && -z $(find -L";
        for (const auto& source : step.sources)
            condition += fmt::format(" {}", shellWord(source.string()));
        condition += fmt::format(" -type f -newer {} -print -quit)", product);
    }
    return fmt::format(
        "        if [[ {} ]]; then\n"
        "            printf '%s: done\\n' {}\n"
        "            exit 0\n"
        "        fi\n",
        condition, product);
}

/// The branch of a step.
std::string branchOf(const FarmStep& step) {
    std::string text = fmt::format("    {})\n        values=(", step.name);
    for (const std::string& value : step.values)
        text += fmt::format("{}{}", text.ends_with("(") ? "" : " ", shellWord(value));
    text += ")\n        value=${values[task - 1]-}\n        [[ -n $value ]] || usage\n";
    text += skipWhatIsDone(step);
    text += fmt::format("        exec {}", shellWord(step.program));
    for (const FarmWord& word : step.arguments)
        text += fmt::format("{}{}", word.text.starts_with("-") ? " \\\n            " : " ",
                            scriptWord(word));
    return text + "\n        ;;\n";
}

}  // namespace

std::string shellWord(const std::string& text) {
    static const std::string plain =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-+=./,:@%";
    if (!text.empty() && text.find_first_not_of(plain) == std::string::npos) return text;
    std::string word = "'";
    for (const char c : text) word += c == '\'' ? "'\\''" : std::string(1, c);
    return word + "'";
}

std::string forwardingSignals() {
    return "# Runs a command, which gets the signals that this script gets; leaves its $status.\n"
           "stopped=''\n"
           "attempt() {\n"
           "    local child=''\n"
           "    trap 'stopped=1; [[ -z $child ]] || kill -TERM \"$child\" 2>/dev/null' INT TERM\n"
           "    \"$@\" &\n"
           "    child=$! status=0\n"
           "    wait \"$child\" || status=$?\n"
           "    # A signal ends the wait before the program.\n"
           "    if [[ -n $stopped ]]; then status=0; wait \"$child\" || status=$?; fi\n"
           "}\n";
}

std::string runScript(const FarmPlan& plan) {
    std::string usage, branches;
    for (const FarmStep& step : plan.steps) {
        usage += fmt::format("#   run {} TASK    (1 to {})\n", step.name, step.values.size());
        branches += branchOf(step);
    }
    return "#!/usr/bin/env bash\n"
           "# Runs one task of this job; written by shadowcache-farm " +
           std::string(kVersion) + ".\n" + usage +
           "#   run again STEP TASK    the same, up to three times where it is interrupted\n"
           "# What is done is not done again. Exit status: 0 done, 1 failed, trying again is "
           "useless;\n"
           "# 2 wrong usage; 75 interrupted, try again. SHADOWCACHE_BIN is the folder of the "
           "programs.\n"
           "set -uo pipefail\n"
           "\n"
           "usage() {\n"
           "    sed -n '2,/^set/{s/^# //p}' \"${BASH_SOURCE[0]}\" >&2\n"
           "    exit 2\n"
           "}\n"
           "\n" +
           forwardingSignals() +
           "\n"
           "if [[ ${1-} == again ]]; then\n"
           "    shift\n"
           "    for try in 1 2 3; do\n"
           "        attempt \"$BASH\" \"${BASH_SOURCE[0]}\" \"$@\"\n"
           "        [[ $status -eq 75 && -z $stopped ]] || break\n"
           "    done\n"
           "    exit \"$status\"\n"
           "fi\n"
           "\n"
           "PATH=${SHADOWCACHE_BIN:-" +
           shellWord(plan.programs) +
           "}:$PATH\n"
           "cd " +
           shellWord(plan.work.string()) +
           " || exit 1\n"
           "task=${2-1}\n"
           "[[ $task =~ ^[1-9][0-9]{0,8}$ ]] || usage\n"
           "case ${1-} in\n" +
           branches +
           "    *) usage ;;\n"
           "esac\n";
}

}  // namespace shadowcache
