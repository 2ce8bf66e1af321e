#pragma once

#include <sstream>
#include <string>
#include <utility>

namespace shadowcache {

/// String streams that throw std::bad_alloc where memory ends. The standard ones keep that to
/// themselves: a text is cut, a list is read as far as it came.
struct TextWriter : std::ostringstream {
    TextWriter() { exceptions(std::ios::badbit); }
};

struct TextReader : std::istringstream {
    explicit TextReader(std::string text) : std::istringstream(std::move(text), std::ios::binary) {
        exceptions(std::ios::badbit);
    }
};

}  // namespace shadowcache
