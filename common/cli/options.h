#pragma once

#include <span>

#include "common/base/option_row.h"

namespace CLI {  // NOLINT(readability-identifier-naming)
class App;
}  // namespace CLI

namespace shadowcache {

/// Defines the options of a table.
void addRows(CLI::App& app, std::span<const OptionRow> rows);

/// Reads those of them that were given, once the command line is parsed. @throws Error
void readRows(const CLI::App& app, std::span<const OptionRow> rows);

}  // namespace shadowcache
