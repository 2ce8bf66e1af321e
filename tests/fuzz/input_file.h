#pragma once

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <string>

#include "common/base/error.h"
#include "tests/support/temporary_folder.h"

namespace shadowcache::fuzz {

/// The file that a fuzzer's reader is given, with other bytes each time.
class InputFile {
public:
    explicit InputFile(const std::string& name) : path_(folder_.path() / name) {}

    const std::filesystem::path& write(std::span<const std::uint8_t> bytes) {
        const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path_.c_str(), "wb"),
                                                                   std::fclose);
        if (!file || std::fwrite(bytes.data(), 1, bytes.size(), file.get()) != bytes.size())
            std::abort();
        return path_;
    }

private:
    test::TemporaryFolder folder_;
    std::filesystem::path path_;
};

/// Reads the bytes as a file: `read` may refuse it with an Error that names the file, and do
/// nothing else. Other exceptions are not caught and are faults.
template <class Read>
void readAs(InputFile& file, std::span<const std::uint8_t> bytes, const Read& read) {
    const std::filesystem::path& path = file.write(bytes);
    try {
        read(path);
    } catch (const Error& e) {
        if (std::string(e.what()).find(path.string()) == std::string::npos) {
            std::fprintf(stderr, "a refusal that does not name the file: %s\n", e.what());
            std::abort();
        }
    }
}

/// Ends the run if a promise is broken.
inline void require(bool kept) {
    if (!kept) std::abort();
}

}  // namespace shadowcache::fuzz
