#include "render/serve/fields.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/base/error.h"
#include "common/base/json_keys.h"
#include "common/base/number_text.h"

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

/// A number as a command line has it; nothing of what is none.
std::string numberOf(const Json& json) {
    if (json.is_number_unsigned()) return std::to_string(json.get<std::uint64_t>());
    if (json.is_number_integer()) return std::to_string(json.get<std::int64_t>());
    return isFinite(json) ? numberText(json.get<double>()) : "";
}

/// Numbers, joined by commas; nothing where one is none.
std::string numbersOf(const Json& json) {
    if (!json.is_array()) return numberOf(json);
    std::string all;
    for (const Json& part : json) {
        if (!isFinite(part)) return "";
        all += (all.empty() ? "" : ",") + numberOf(part);
    }
    return all;
}

std::string fieldsOf(const Json& json) {
    std::string all;
    for (const auto& [key, value] : json.items()) {
        const std::string number = numberOf(value);
        if (number.empty()) return "";
        all += (all.empty() ? "" : ",") + key + "=" + number;
    }
    return all;
}

/// What a value of an option looks like in JSON.
std::string formOf(const OptionRow& row) {
    switch (row.form) {
        case OptionForm::flag:
            return "true or false";
        case OptionForm::whole:
            return "a whole number" + (row.orWord ? ", or \"" + *row.orWord + "\"" : "");
        case OptionForm::number:
            return "a number";
        case OptionForm::numbers: {
            std::string counts;
            for (const std::size_t count : row.counts)
                counts += fmt::format("{}{}", counts.empty() ? "" : " or ", count);
            return counts + " numbers";
        }
        case OptionForm::fields:
            return "an object of numbers";
        case OptionForm::word:
        case OptionForm::text:
            return "text";
        case OptionForm::words:
        case OptionForm::texts:
            break;
    }
    return "a list of texts";
}

/// A value as the texts that a command line would have; none if it is of another form.
std::vector<std::string> textsOf(const Json& json, const OptionRow& row) {
    std::string text;
    switch (row.form) {
        case OptionForm::flag:
            if (json.is_boolean()) text = json.get<bool>() ? "true" : "false";
            break;
        case OptionForm::whole:
            if (json.is_number_integer()) text = numberOf(json);
            if (row.orWord && json == *row.orWord) text = *row.orWord;
            break;
        case OptionForm::number:
            text = numberOf(json);
            break;
        case OptionForm::numbers:
            if (std::ranges::find(row.counts, json.is_array() ? json.size() : 1) !=
                row.counts.end())
                text = numbersOf(json);
            break;
        case OptionForm::fields:
            if (json.is_object()) text = fieldsOf(json);
            break;
        case OptionForm::word:
        case OptionForm::text:
            if (isText(json)) return {json.get<std::string>()};
            break;
        case OptionForm::words:
        case OptionForm::texts:
            if (json.is_array() && std::ranges::all_of(json, isText))
                return json.get<std::vector<std::string>>();
    }
    if (text.empty()) return {};
    return {text};
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

void Fields::refuse(const std::string& key, const std::string& wanted) const {
    throw Error(
        fmt::format("{}: {} is {}, expected {}", where_, key, quoted(object_.at(key)), wanted));
}

void Fields::refuseWithout(const std::string& key) const {
    throw Error(fmt::format("{}: has no {}", where_, key));
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

void Fields::read(std::span<const OptionRow> rows) {
    const auto at = [this](auto&& work) {
        try {
            work();
        } catch (const Error& e) {
            throw Error(fmt::format("{}: {}", where_, e.what()));
        }
    };
    std::vector<std::string> given;
    for (const OptionRow& row : rows) {
        if (!row.isAt(Door::serve)) continue;
        const std::string key = row.nameAt(Door::serve);
        const Json* json = find(key);
        if (!json) continue;
        given.push_back(row.name);
        const std::vector<std::string> texts = textsOf(*json, row);
        const bool isEmptyList = row.takesSeveral() && json->is_array() && json->empty();
        const bool isEmptyObject =
            row.form == OptionForm::fields && json->is_object() && json->empty();
        if (texts.empty() && !isEmptyList && !isEmptyObject) refuse(key, formOf(row));
        at([&] { row.read(texts); });
    }
    at([&] { requireTogether(rows, given); });
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
