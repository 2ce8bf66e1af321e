#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace shadowcache {

/// A value and the word that an option has for it. Tables of these stand beside the type.
template <class Value>
struct Named {
    const char* name;
    Value value;
};

template <class Value, std::size_t n>
std::vector<std::string> namesOf(const Named<Value> (&table)[n]) {
    std::vector<std::string> names;
    for (const Named<Value>& entry : table) names.emplace_back(entry.name);
    return names;
}

}  // namespace shadowcache
