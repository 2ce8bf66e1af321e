#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace shadowcache {

// What the texts of options are read with. Each throws Error "--NAME TEXT: expected WANTED".

[[noreturn]] void refuseText(const std::string& name, const std::string& text,
                             const std::string& wanted);

/// Finite numbers joined by commas, as many as one of `counts`.
std::vector<double> numbersOf(const std::string& name, const std::string& text,
                              const std::vector<std::size_t>& counts, const std::string& wanted);

/// "AxB" or "A,B": two whole numbers of 0 or more.
std::array<int, 2> pairOf(const std::string& name, const std::string& text,
                          const std::string& wanted);

/// A size in bytes: a number above 0 with or without K, M, G or T (of 1024), as in 4G, 1.5G, 512MB.
std::uint64_t bytesOf(const std::string& name, const std::string& text);

}  // namespace shadowcache
