#pragma once

#include <optional>
#include <vector>

#include "bake/core/options.h"
#include "common/base/option_row.h"

namespace shadowcache {

/// The options of a bake, for every way in. One more is one more row, its effect, and a line of
/// docs.
///
/// @param chosenSpacings  has the spacing as times the one that is chosen, if it is given so
std::vector<OptionRow> bakeRows(BakeOptions& bake, std::optional<double>& chosenSpacings);

/// Of a bake for a shot.
OptionRow marginRow(int& margin);

}  // namespace shadowcache
