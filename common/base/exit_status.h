#pragma once

namespace shadowcache {

// The programs' exit statuses, which a farm acts on; docs/farm.md has them for the user.

constexpr int kDone = 0;
/// The work cannot be done as asked; trying again is useless.
constexpr int kFailed = 1;
/// The command line cannot be parsed.
constexpr int kWrongUsage = 2;
/// The work was interrupted and can be tried again: EX_TEMPFAIL of sysexits.h.
constexpr int kTryAgain = 75;

}  // namespace shadowcache
