#include "common/base/report_failure.h"

#include <cstdio>

#include "common/base/exit_status.h"
#include "common/base/interrupt.h"

namespace shadowcache {

int reportFailure(const char* program, const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", program, error.what());
    return dynamic_cast<const Interrupted*>(&error) != nullptr ? kTryAgain : kFailed;
}

}  // namespace shadowcache
