#pragma once

#include <string>
#include <vector>

namespace shadowcache::test {

/// Numbers at the ends of what types hold, and what is no number, as a user or a file writes them.
inline const std::vector<std::string>& extremeNumbers() {
    static const std::vector<std::string> numbers{"inf",
                                                  "-inf",
                                                  "nan",
                                                  "1e999",
                                                  "1e308",
                                                  "-1e308",
                                                  "1e39",
                                                  "-1e39",
                                                  "1e38",
                                                  "-1e38",
                                                  "1e-38",
                                                  "1e-39",
                                                  "5e-324",
                                                  "-5e-324",
                                                  "0",
                                                  "-0",
                                                  "-1",
                                                  "1e13",
                                                  "2147483647",
                                                  "2147483648",
                                                  "-2147483648",
                                                  "4294967296",
                                                  "-4294967297",
                                                  "9007199254740993",
                                                  "9223372036854775808",
                                                  "18446744073709551615",
                                                  "18446744073709551616"};
    return numbers;
}

}  // namespace shadowcache::test
