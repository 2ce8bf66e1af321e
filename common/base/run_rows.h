#pragma once

#include "common/base/option_row.h"

namespace shadowcache {

// Options of how a program runs, which change no result.

/// --threads.
OptionRow threadsRow(int& threads);

/// --progress, which takes effect as it is read.
OptionRow progressRow();

}  // namespace shadowcache
