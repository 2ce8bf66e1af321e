#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

namespace shadowcache {

/// Bad input or a missing resource; the text names the thing, what was found and what is wanted.
class Error : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// Throws Error with the text "PATH: cause".
[[noreturn]] inline void throwFileError(const std::filesystem::path& path,
                                        const std::string& cause) {
    throw Error(path.string() + ": " + cause);
}

}  // namespace shadowcache
