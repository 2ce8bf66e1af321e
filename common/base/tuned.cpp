#include "common/base/tuned.h"

#ifdef SHADOWCACHE_TUNABLE
#include <cmath>
#include <cstdlib>
#include <string>

#include "common/base/error.h"

namespace shadowcache {

double tunedValue(const char* name, double value) {
    const std::string variable = std::string("SHADOWCACHE_") + name;
    const char* text = std::getenv(variable.c_str());
    if (!text) return value;
    char* end = nullptr;
    const double read = std::strtod(text, &end);
    if (end == text || *end != '\0' || !std::isfinite(read))
        throw Error(variable + ": found \"" + text + "\", expected a number");
    return read;
}

}  // namespace shadowcache
#endif
