#pragma once

#include <cstdlib>
#include <sstream>
#include <string>

namespace shadowcache {

/// A number as it was typed would be: the shortest text that reads back.
inline std::string numberText(double value) {
    std::ostringstream text;
    text << value;
    if (std::strtod(text.str().c_str(), nullptr) == value) return text.str();
    std::ostringstream exact;
    exact.precision(17);
    exact << value;
    return exact.str();
}

}  // namespace shadowcache
