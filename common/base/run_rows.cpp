#include "common/base/run_rows.h"

#include "common/base/option_checks.h"
#include "common/base/progress.h"

namespace shadowcache {

OptionRow threadsRow(int& threads) {
    return wholeRow("threads", threads, 0, kMaxThreads, "Threads; 0: one per core").notCompared();
}

OptionRow progressRow() {
    return option_row::word(
               "progress", [](std::size_t i) { setProgressStyle(kProgressStyles[i].value); },
               namesOf(kProgressStyles),
               "Progress on standard error: none, bar, lines (every ten seconds) or json (one "
               "object a second) [bar on a terminal, lines elsewhere]")
        .notCompared();
}

}  // namespace shadowcache
