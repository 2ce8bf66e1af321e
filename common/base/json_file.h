#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace shadowcache {

/// A JSON object built by dotted keys: set("seconds.load", 0.5) makes {"seconds": {"load": 0.5}}.
class JsonFile {
public:
    JsonFile();
    ~JsonFile();

    void set(const std::string& key, double value);
    void set(const std::string& key, std::uint64_t value);
    void set(const std::string& key, const std::string& value);
    void set(const std::string& key, const std::vector<double>& values);
    void set(const std::string& key, const std::vector<std::uint64_t>& values);

    /// Indented text.
    std::string text() const;

    /// Writes the text, beside the target first, then renamed.
    ///
    /// @throws Error if it cannot be written
    void write(const std::filesystem::path& path) const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace shadowcache
