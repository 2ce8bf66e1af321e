#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "common/base/named.h"

namespace CLI {  // NOLINT(readability-identifier-naming)
class App;
class Option;
}  // namespace CLI

namespace shadowcache {

// Kinds of options that CLI11 does not have in this form.

/// Defines an option that takes one of `words`, and calls `choose` with the place of that word.
///
/// @param standard  the word that --help shows as the default; empty: none
CLI::Option* addWordOption(CLI::App& app, const std::string& name,
                           const std::vector<std::string>& words,
                           const std::function<void(std::size_t)>& choose,
                           const std::string& description, const std::string& standard = "");

/// Defines an option that takes one of the names in `table`, which must outlive the parsing; the
/// default is the value that `value` has.
template <class Value, std::size_t n>
CLI::Option* addChoice(CLI::App& app, const std::string& name, Value& value,
                       const Named<Value> (&table)[n], const std::string& description) {
    std::string standard;
    for (const Named<Value>& entry : table)
        if (entry.value == value) standard = entry.name;
    const auto choose = [&value, &table](std::size_t i) { value = table[i].value; };
    return addWordOption(app, name, namesOf(table), choose, description, standard);
}

/// Defines an option that takes any of `words`, joined by commas or spaces.
CLI::Option* addListOption(CLI::App& app, const std::string& name, std::vector<std::string>& chosen,
                           const std::vector<std::string>& words, const std::string& description);

/// Defines --seed, from 0 to 2^64 - 1: CLI11 would convert -1 and 2^64, too.
CLI::Option* addSeedOption(CLI::App& app, std::uint64_t& seed, const std::string& description);

/// Defines --threads.
void addThreadsOption(CLI::App& app, int& threads, const std::string& group);

/// Defines --progress, which takes effect as it is parsed.
void addProgressOption(CLI::App& app, const std::string& group);

}  // namespace shadowcache
