#pragma once

#include <cstddef>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <set>
#include <string>
#include <vector>

#include "common/base/named.h"

namespace shadowcache {

/// An object of a glTF file's JSON, whose members are asked for by name and kind. What is missing
/// is the default; what is of another kind is refused by the names of the object and the member.
class GltfObject {
public:
    /// @param path   of the file
    /// @param json   an object; outlives this, as `path` does
    /// @param owner  what messages call it, as "node 3"; empty: the file
    GltfObject(const std::filesystem::path& path, const nlohmann::json& json, std::string owner);

    bool has(const char* key) const;
    double number(const char* key, double fallback) const;
    /// A whole number from 0 on, which may be written 1.0 or 1e0. [glTF 2.0, Sec. 2.7]
    std::size_t count(const char* key, std::size_t fallback) const;
    /// Number of one of `size` things; -1: there is no such member.
    ///
    /// @param thing  what messages call it; empty: as the member
    int index(const char* key, std::size_t size, const std::string& thing = {}) const;
    bool flag(const char* key, bool fallback) const;
    std::string text(const char* key) const;
    /// A list of so many numbers; empty: there is no such member.
    std::vector<double> numbers(const char* key, std::size_t size) const;
    std::vector<double> numbers(const char* key) const;
    /// Numbers of some of `size` things.
    std::vector<int> indices(const char* key, std::size_t size, const std::string& thing) const;
    /// One of the values of a choice.
    template <class T, std::size_t Count>
    T choice(const char* key, const Named<T> (&values)[Count], T fallback) const {
        if (!has(key)) return fallback;
        const std::string found = text(key);
        std::string all;
        for (const Named<T>& value : values) {
            if (found == value.name) return value.value;
            all += (all.empty() ? "one of " : ", ") + std::string(value.name);
        }
        refuse(key, all);
    }

    /// A member that is an object; one without members where there is none.
    GltfObject object(const char* key) const;
    /// An extension of this name.
    GltfObject extension(const char* name) const;
    bool hasExtension(const char* name) const;
    /// The objects of a list, named "KIND 3".
    std::vector<GltfObject> objects(const char* key, const char* kind) const;
    std::vector<std::string> texts(const char* key) const;
    std::vector<std::string> keys() const;
    /// Names of the extensions of the object and of all that is in it, but for `extras`.
    std::set<std::string> extensionNames() const;

    std::string name() const;
    /// What messages call it: "node 3 (lamp)".
    std::string owner() const;

    /// @throws Error "PATH: OWNER: CAUSE"
    [[noreturn]] void fail(const std::string& cause) const;
    /// @throws Error "PATH: OWNER: KEY VALUE, expected WANTED"
    [[noreturn]] void refuse(const char* key, const std::string& wanted) const;

private:
    const nlohmann::json* find(const char* key) const;
    int indexOf(const nlohmann::json& value, std::size_t size, const char* key,
                const std::string& thing) const;

    const std::filesystem::path* path_;
    const nlohmann::json* json_;
    std::string owner_;
};

}  // namespace shadowcache
