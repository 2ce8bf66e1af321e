#include "render/serve/replies.h"

#include <nlohmann/json.hpp>
#include <utility>

namespace shadowcache {

Replies::Replies(Sink sink) : sink_(std::move(sink)) {}

void Replies::done(std::optional<std::uint64_t> number, const Json& fields) {
    send(number, "done", fields);
}

void Replies::error(std::optional<std::uint64_t> number, const std::string& text) {
    send(number, "error", {{"error", text}});
}

void Replies::picture(std::optional<std::uint64_t> number, const Json& fields) {
    send(number, "picture", fields);
}

void Replies::stopped(std::optional<std::uint64_t> number) {
    send(number, "stopped", Json::object());
}

void Replies::log(std::optional<std::uint64_t> number, const std::string& text) {
    send(number, "log", {{"text", text}});
}

void Replies::progress(std::optional<std::uint64_t> number, const std::string& task,
                       std::uint64_t done, std::uint64_t total) {
    send(number, "progress", {{"task", task}, {"done", done}, {"total", total}});
}

void Replies::send(std::optional<std::uint64_t> number, const char* kind, const Json& fields) {
    Json line;
    line["id"] = number ? Json(*number) : Json(nullptr);
    line["reply"] = kind;
    line.update(fields);
    // Names of files may be no UTF-8.
    const std::string text = line.dump(-1, ' ', true, Json::error_handler_t::replace) + "\n";
    const std::lock_guard lock(mutex_);
    sink_(text);
}

}  // namespace shadowcache
