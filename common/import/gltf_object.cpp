#include "common/import/gltf_object.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "common/base/error.h"
#include "common/base/report_failure.h"

namespace shadowcache {

namespace {

using Json = nlohmann::json;

/// Text of a value in a message.
std::string shown(const Json& value) {
    constexpr std::size_t kMostBytes = 60;
    return oneLine(value.dump(-1, ' ', true, Json::error_handler_t::replace).substr(0, kMostBytes));
}

/// Beyond it not every whole number is a double.
constexpr double kMostCount = 0x1p53;

std::optional<std::size_t> wholeNumber(const Json& value) {
    if (!value.is_number()) return {};
    const auto number = value.get<double>();
    if (!(number >= 0 && number < kMostCount) || number != std::floor(number)) return {};
    return static_cast<std::size_t>(number);
}

const Json& nothing() {
    static const Json kNothing = Json::object();
    return kNothing;
}

}  // namespace

GltfObject::GltfObject(const std::filesystem::path& path, const Json& json, std::string owner)
    : path_(&path), json_(&json), owner_(std::move(owner)) {
    if (json.is_object()) return;
    json_ = &nothing();
    fail(shown(json) + ", expected an object");
}

const Json* GltfObject::find(const char* key) const {
    const auto found = json_->find(key);
    return found == json_->end() ? nullptr : &*found;
}

bool GltfObject::has(const char* key) const {
    return find(key) != nullptr;
}

double GltfObject::number(const char* key, double fallback) const {
    const Json* value = find(key);
    if (!value) return fallback;
    if (!value->is_number()) refuse(key, "a number");
    return value->get<double>();
}

std::size_t GltfObject::count(const char* key, std::size_t fallback) const {
    const Json* value = find(key);
    if (!value) return fallback;
    const auto number = wholeNumber(*value);
    if (!number) refuse(key, "a whole number from 0 on");
    return *number;
}

int GltfObject::indexOf(const Json& value, std::size_t size, const char* key,
                        const std::string& thing) const {
    const auto number = wholeNumber(value);
    const bool isWhole = number || (value.is_number_integer() && !value.is_number_unsigned());
    if (!isWhole) refuse(key, "a whole number");
    if (number && *number < std::min<std::size_t>(size, std::numeric_limits<int>::max()))
        return static_cast<int>(*number);
    fail(fmt::format(
        "{} {}{}", thing, shown(value),
        size == 0 ? ", but the file has none" : fmt::format(", expected 0 to {}", size - 1)));
}

int GltfObject::index(const char* key, std::size_t size, const std::string& thing) const {
    const Json* value = find(key);
    return value ? indexOf(*value, size, key, thing.empty() ? key : thing) : -1;
}

bool GltfObject::flag(const char* key, bool fallback) const {
    const Json* value = find(key);
    if (!value) return fallback;
    if (!value->is_boolean()) refuse(key, "true or false");
    return value->get<bool>();
}

std::string GltfObject::text(const char* key) const {
    const Json* value = find(key);
    if (!value) return {};
    if (!value->is_string()) refuse(key, "text");
    return value->get<std::string>();
}

std::vector<double> GltfObject::numbers(const char* key) const {
    const Json* value = find(key);
    if (!value) return {};
    if (!value->is_array() ||
        !std::ranges::all_of(*value, [](const Json& x) { return x.is_number(); }))
        refuse(key, "a list of numbers");
    return value->get<std::vector<double>>();
}

std::vector<double> GltfObject::numbers(const char* key, std::size_t size) const {
    const Json* value = find(key);
    const bool fits = !value || (value->is_array() && value->size() == size &&
                                 std::ranges::all_of(*value, &Json::is_number));
    if (!fits) refuse(key, fmt::format("a list of {} numbers", size));
    return numbers(key);
}

std::vector<int> GltfObject::indices(const char* key, std::size_t size,
                                     const std::string& thing) const {
    std::vector<int> found;
    const Json* list = find(key);
    if (!list) return found;
    if (!list->is_array()) refuse(key, "a list of whole numbers");
    for (const Json& value : *list) found.push_back(indexOf(value, size, key, thing));
    return found;
}

GltfObject GltfObject::object(const char* key) const {
    const Json* value = find(key);
    return {*path_, value ? *value : nothing(),
            owner_.empty() ? std::string(key) : owner() + ": " + key};
}

GltfObject GltfObject::extension(const char* name) const {
    GltfObject found = object("extensions").object(name);
    found.owner_ = owner_.empty() ? std::string(name) : owner() + ": " + name;
    return found;
}

bool GltfObject::hasExtension(const char* name) const {
    return object("extensions").has(name);
}

std::vector<GltfObject> GltfObject::objects(const char* key, const char* kind) const {
    std::vector<GltfObject> found;
    const Json* list = find(key);
    if (!list) return found;
    if (!list->is_array()) refuse(key, "a list");
    const std::string prefix = (owner_.empty() ? "" : owner() + ", ") + kind;
    for (const Json& value : *list)
        found.emplace_back(*path_, value, fmt::format("{} {}", prefix, found.size()));
    return found;
}

std::vector<std::string> GltfObject::texts(const char* key) const {
    const Json* list = find(key);
    if (!list) return {};
    if (!list->is_array() || !std::ranges::all_of(*list, &Json::is_string))
        refuse(key, "a list of texts");
    return list->get<std::vector<std::string>>();
}

std::vector<std::string> GltfObject::keys() const {
    std::vector<std::string> found;
    for (const auto& item : json_->items()) found.push_back(item.key());
    return found;
}

std::set<std::string> GltfObject::extensionNames() const {
    std::set<std::string> found;
    std::vector<const Json*> open{json_};
    while (!open.empty()) {
        const Json& thing = *open.back();
        open.pop_back();
        for (const auto& item : thing.items()) {
            const bool isMember = thing.is_object();
            if (isMember && item.key() == "extras") continue;
            if (isMember && item.key() == "extensions" && item.value().is_object())
                for (const auto& extension : item.value().items()) found.insert(extension.key());
            if (item.value().is_structured()) open.push_back(&item.value());
        }
    }
    return found;
}

std::string GltfObject::name() const {
    const Json* value = find("name");
    return value && value->is_string() ? value->get<std::string>() : std::string();
}

std::string GltfObject::owner() const {
    const std::string found = owner_.empty() ? std::string() : name();
    return found.empty() ? owner_ : fmt::format("{} ({})", owner_, found);
}

void GltfObject::fail(const std::string& cause) const {
    throwFileError(*path_, owner_.empty() ? cause : owner() + ": " + cause);
}

void GltfObject::refuse(const char* key, const std::string& wanted) const {
    fail(fmt::format("{} {}, expected {}", key, shown(*find(key)), wanted));
}

}  // namespace shadowcache
