#pragma once

#include <cstdlib>
#include <string>

#include "common/base/text_streams.h"

namespace shadowcache {

/// A number as it was typed would be: the shortest text that reads back.
inline std::string numberText(double value) {
    TextWriter text;
    text << value;
    if (std::strtod(text.str().c_str(), nullptr) == value) return text.str();
    TextWriter exact;
    exact.precision(17);
    exact << value;
    return exact.str();
}

}  // namespace shadowcache
