#include "common/import/gltf_shapes.h"

#include <fmt/core.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/base/error.h"
#include "common/base/report_failure.h"

namespace shadowcache {

namespace {

using Json = nlohmann::json;

/// A member of an object, or null.
const Json* member(const Json& object, const char* key) {
    const auto at = object.is_object() ? object.find(key) : object.end();
    return object.is_object() && at != object.end() ? &*at : nullptr;
}

/// Text of a value in a message.
std::string shown(const Json& value) {
    constexpr std::size_t kMostBytes = 60;
    return oneLine(value.dump(-1, ' ', true, Json::error_handler_t::replace).substr(0, kMostBytes));
}

class Shapes {
public:
    explicit Shapes(const std::filesystem::path& path) : path_(path) {}

    void check(const Json& document) {
        each(document, "nodes", "node", [this](const Json& node) { checkNode(node); });
        each(document, "materials", "material", [this](const Json& m) { checkMaterial(m); });
        each(document, "samplers", "sampler", [this](const Json& sampler) {
            for (const char* key : {"wrapS", "wrapT"})
                require(sampler, key, "33071, 33648 or 10497", [](const Json& value) {
                    return value == 33071 || value == 33648 || value == 10497;
                });
        });
        each(document, "animations", "animation", [this](const Json& a) { checkAnimation(a); });
    }

private:
    /// Calls `take` for the objects of a list.
    template <class Take>
    void each(const Json& object, const char* list, const char* kind, const Take& take) {
        const Json* found = member(object, list);
        if (!found || !found->is_array()) return;
        for (std::size_t i = 0; i < found->size(); ++i) {
            owner_ = fmt::format("{} {}", kind, i);
            take((*found)[i]);
        }
    }

    template <class Holds>
    void require(const Json& object, const char* key, const std::string& expected,
                 const Holds& holds) const {
        const Json* value = member(object, key);
        if (value && !holds(*value))
            throwFileError(path_,
                           owner_ + ": " + key + " " + shown(*value) + ", expected " + expected);
    }

    void requireNumbers(const Json& object, const char* key, std::size_t count) const {
        require(object, key, fmt::format("a list of {} numbers", count), [&](const Json& value) {
            return value.is_array() && value.size() == count &&
                   std::ranges::all_of(value, [](const Json& x) { return x.is_number(); });
        });
    }

    void requireNumber(const Json& object, const char* key) const {
        require(object, key, "a number", [](const Json& value) { return value.is_number(); });
    }

    void requireWord(const Json& object, const char* key,
                     const std::vector<std::string>& words) const {
        std::string list;
        for (const std::string& word : words) list += (list.empty() ? "" : ", ") + word;
        require(object, key, "one of " + list, [&](const Json& value) {
            return std::ranges::any_of(words,
                                       [&](const std::string& word) { return value == word; });
        });
    }

    void checkNode(const Json& node) const {
        requireNumbers(node, "translation", 3);
        requireNumbers(node, "rotation", 4);
        requireNumbers(node, "scale", 3);
        requireNumbers(node, "matrix", 16);
        require(node, "matrix", "0, 0, 0, 1 in the last row",
                [](const Json& m) { return m[3] == 0 && m[7] == 0 && m[11] == 0 && m[15] == 1; });
    }

    void checkMaterial(const Json& material) const {
        requireNumbers(material, "emissiveFactor", 3);
        requireNumber(material, "alphaCutoff");
        requireWord(material, "alphaMode", {"OPAQUE", "MASK", "BLEND"});
        require(material, "doubleSided", "true or false",
                [](const Json& value) { return value.is_boolean(); });
        const Json* pbr = member(material, "pbrMetallicRoughness");
        if (!pbr) return;
        requireNumbers(*pbr, "baseColorFactor", 4);
        requireNumber(*pbr, "metallicFactor");
        requireNumber(*pbr, "roughnessFactor");
    }

    void checkAnimation(const Json& animation) {
        const std::string owner = owner_;
        each(animation, "samplers", (owner + ", sampler").c_str(), [this](const Json& sampler) {
            requireWord(sampler, "interpolation", {"LINEAR", "STEP", "CUBICSPLINE"});
        });
        each(animation, "channels", (owner + ", channel").c_str(), [this](const Json& channel) {
            // A pointer is of KHR_animation_pointer, which is named.
            if (const Json* target = member(channel, "target"))
                requireWord(*target, "path",
                            {"translation", "rotation", "scale", "weights", "pointer"});
        });
    }

    const std::filesystem::path& path_;
    std::string owner_;  ///< of what is being checked, for messages
};

}  // namespace

void requireShapes(const std::filesystem::path& path, const Json& document) {
    Shapes(path).check(document);
}

}  // namespace shadowcache
