#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "common/base/error.h"

namespace shadowcache::test {

/// Folder of one test's own, removed with all it holds.
class TemporaryFolder {
public:
    TemporaryFolder() {
        std::string name =
            (std::filesystem::temp_directory_path() / "shadowcache-test-XXXXXX").string();
        if (!mkdtemp(name.data())) throw Error(name + ": cannot be created");
        path_ = name;
    }
    ~TemporaryFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    const std::filesystem::path& path() const { return path_; }

    std::filesystem::path write(const std::string& name, const std::string& bytes) const {
        std::ofstream(path_ / name, std::ios::binary) << bytes;
        return path_ / name;
    }

private:
    std::filesystem::path path_;
};

inline std::string readBytes(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

/// Expects `action` to throw an Error of one line that holds both texts.
template <class Action>
void expectError(const Action& action, const std::string& file, const std::string& cause) {
    try {
        action();
        ADD_FAILURE() << file << ": no error, expected one with '" << cause << "'";
    } catch (const Error& e) {
        const std::string text = e.what();
        EXPECT_NE(text.find(file), std::string::npos) << text;
        EXPECT_NE(text.find(cause), std::string::npos) << text;
        EXPECT_EQ(text.find('\n'), std::string::npos) << text;
        EXPECT_LT(text.size(), 400u) << text;
    }
}

}  // namespace shadowcache::test
