#include "common/base/report_failure.h"

#include <cctype>
#include <cstdio>

#include "common/base/exit_status.h"
#include "common/base/interrupt.h"

namespace shadowcache {

std::string oneLine(std::string text) {
    constexpr std::size_t kMost = 8192, kEnd = 512;
    if (text.size() > kMost) text.replace(kMost - kEnd, text.size() - kMost, "...");
    for (char& c : text)
        if (std::iscntrl(static_cast<unsigned char>(c))) c = '?';
    return text;
}

int reportFailure(const char* program, const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", program, oneLine(error.what()).c_str());
    return dynamic_cast<const Interrupted*>(&error) != nullptr ? kTryAgain : kFailed;
}

}  // namespace shadowcache
