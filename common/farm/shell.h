#pragma once

#include <string>

#include "common/farm/plan.h"

namespace shadowcache {

/// The text as one word of a shell, whatever it holds; quoted only where it must be.
std::string shellWord(const std::string& text);

/// A script that runs one task: run STEP TASK, or run again STEP TASK, which tries three times
/// where a task ends with 75. Every scheduler calls it, so that command lines are quoted in one
/// place.
std::string runScript(const FarmPlan& plan);

/// A function of a shell: `attempt COMMAND...` runs a command, passes Ctrl-C and SIGTERM on to it
/// and leaves its exit status in $status; $stopped is not empty after a signal.
std::string forwardingSignals();

}  // namespace shadowcache
