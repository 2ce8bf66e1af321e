#pragma once

#include <map>
#include <string>
#include <vector>

namespace shadowcache::test {

/// A program, a command line that runs, and the options whose text holds numbers: '@' is one.
struct Subject {
    std::string program;
    std::string arguments;
    std::map<std::string, std::vector<std::string>> forms;
    std::map<std::string, std::string> needs{};  ///< arguments to add beside an option
    int parts = 1;                               ///< tests that its options are divided among
};

/// One subject for every program.
std::vector<Subject> subjects();

/// The option that lists all options of a program.
std::string helpOf(const Subject& subject);

/// The forms in which a program's options hold numbers, by option, of all options that its help
/// lists. Fails the test that asks if nothing says whether an option holds numbers.
std::map<std::string, std::vector<std::string>> formsOf(const Subject& subject,
                                                        const std::string& help);

}  // namespace shadowcache::test
