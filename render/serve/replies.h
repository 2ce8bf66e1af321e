#pragma once

#include <cstdint>
#include <functional>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

namespace shadowcache {

/// Writes replies, a line each, as they come. Thread-safe.
class Replies {
public:
    using Json = nlohmann::ordered_json;
    using Sink = std::function<void(const std::string& line)>;

    /// @param sink  has each line, its end included
    explicit Replies(Sink sink);

    // Of the request `number`, or of a line without one.
    void done(std::optional<std::uint64_t> number, const Json& fields);
    void error(std::optional<std::uint64_t> number, const std::string& text);
    void picture(std::optional<std::uint64_t> number, const Json& fields);
    void stopped(std::optional<std::uint64_t> number);
    void log(std::optional<std::uint64_t> number, const std::string& text);
    void progress(std::optional<std::uint64_t> number, const std::string& task, std::uint64_t done,
                  std::uint64_t total);

private:
    void send(std::optional<std::uint64_t> number, const char* kind, const Json& fields);

    Sink sink_;
    std::mutex mutex_;
};

}  // namespace shadowcache
