#include "render/serve/fields.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/base/error.h"
#include "common/base/json_keys.h"

namespace shadowcache {

namespace {

using Json = nlohmann::json;

constexpr std::size_t kQuotedLength = 60;

std::string quoted(const Json& json) {
    std::string text = json.dump(-1, ' ', true, Json::error_handler_t::replace);
    if (text.size() > kQuotedLength) text.replace(kQuotedLength, text.npos, "...");
    return text;
}

bool isFinite(const Json& json) {
    return json.is_number() && std::isfinite(json.get<double>());
}

/// Text that a file's name may be.
bool isText(const Json& json) {
    return json.is_string() && json.get_ref<const std::string&>().find('\0') == std::string::npos;
}

}  // namespace

Fields::Fields(const Json& object, std::string where) : object_(object), where_(std::move(where)) {
    if (!object.is_object())
        throw Error(fmt::format("{} is {}, expected an object", where_, quoted(object)));
}

const Json* Fields::find(const std::string& key) {
    asked_.push_back(key);
    const auto found = object_.find(key);
    return found == object_.end() ? nullptr : &*found;
}

bool Fields::has(const std::string& key) const {
    return object_.contains(key);
}

bool Fields::hasText(const std::string& key) const {
    return has(key) && object_.at(key).is_string();
}

void Fields::refuse(const std::string& key, const std::string& wanted) const {
    throw Error(
        fmt::format("{}: {} is {}, expected {}", where_, key, quoted(object_.at(key)), wanted));
}

void Fields::refuseWithout(const std::string& key) const {
    throw Error(fmt::format("{}: has no {}", where_, key));
}

std::optional<double> Fields::number(const std::string& key) {
    const Json* json = find(key);
    if (!json) return std::nullopt;
    if (!isFinite(*json)) refuse(key, "a number");
    return json->get<double>();
}

std::optional<std::int64_t> Fields::integer(const std::string& key, std::int64_t least,
                                            std::int64_t most) {
    const Json* json = find(key);
    if (!json) return std::nullopt;
    const std::string wanted = fmt::format("a whole number from {} to {}", least, most);
    if (!json->is_number_integer()) refuse(key, wanted);
    const bool huge =
        json->is_number_unsigned() && json->get<std::uint64_t>() > static_cast<std::uint64_t>(most);
    const auto value = huge ? std::int64_t{0} : json->get<std::int64_t>();
    if (huge || value < least || value > most) refuse(key, wanted);
    return value;
}

std::optional<bool> Fields::flag(const std::string& key) {
    const Json* json = find(key);
    if (!json) return std::nullopt;
    if (!json->is_boolean()) refuse(key, "true or false");
    return json->get<bool>();
}

std::optional<std::string> Fields::text(const std::string& key) {
    const Json* json = find(key);
    if (!json) return std::nullopt;
    if (!isText(*json)) refuse(key, "text");
    return json->get<std::string>();
}

std::optional<std::vector<double>> Fields::numbers(const std::string& key,
                                                   const std::vector<std::size_t>& counts) {
    const Json* json = find(key);
    if (!json) return std::nullopt;
    std::vector<double> all;
    if (isFinite(*json)) all.push_back(json->get<double>());
    if (json->is_array() && std::ranges::all_of(*json, isFinite))
        all = json->get<std::vector<double>>();
    if (std::ranges::find(counts, all.size()) != counts.end()) return all;
    std::string wanted;
    for (const std::size_t count : counts)
        wanted += wanted.empty() ? fmt::format("{}", count) : fmt::format(" or {}", count);
    refuse(key, wanted == "1" ? "a number" : wanted + " numbers");
}

std::optional<std::vector<std::string>> Fields::texts(const std::string& key) {
    const Json* json = find(key);
    if (!json) return std::nullopt;
    if (!json->is_array() || !std::ranges::all_of(*json, isText)) refuse(key, "a list of texts");
    return json->get<std::vector<std::string>>();
}

std::optional<Fields> Fields::object(const std::string& key) {
    const Json* json = find(key);
    if (!json) return std::nullopt;
    return Fields(*json, fmt::format("{}: {}", where_, key));
}

void Fields::requireNoOthers() const {
    const std::string unknown = unknownKey(object_, "", asked_);
    if (!unknown.empty()) throw Error(fmt::format("{}: {}", where_, unknown));
}

}  // namespace shadowcache
