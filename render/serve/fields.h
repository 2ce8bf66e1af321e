#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/base/named.h"

namespace shadowcache {

/// The keys of a JSON object, each asked for by its name; nothing where the object has none of the
/// name. Whatever nobody has asked for is refused in the end.
class Fields {
public:
    /// @param object  outlives the fields
    /// @param where   what the object is called in messages
    /// @throws Error if it is no object
    Fields(const nlohmann::json& object, std::string where);

    /// Each throws Error "WHERE: KEY is VALUE, expected ..." if the value is of another kind.
    std::optional<double> number(const std::string& key);
    std::optional<std::int64_t> integer(const std::string& key, std::int64_t least,
                                        std::int64_t most);
    std::optional<bool> flag(const std::string& key);
    std::optional<std::string> text(const std::string& key);
    /// One number, or as many in a list as one of `counts`.
    std::optional<std::vector<double>> numbers(const std::string& key,
                                               const std::vector<std::size_t>& counts);
    std::optional<std::vector<std::string>> texts(const std::string& key);
    std::optional<Fields> object(const std::string& key);
    /// One of the names of a choice.
    template <class T, std::size_t Count>
    std::optional<T> choice(const std::string& key, const Named<T> (&names)[Count]) {
        const auto found = text(key);
        if (!found) return std::nullopt;
        std::string all;
        for (const Named<T>& named : names) {
            if (*found == named.name) return named.value;
            all += all.empty() ? named.name : std::string(", ") + named.name;
        }
        refuse(key, all);
    }

    bool has(const std::string& key) const;
    bool hasText(const std::string& key) const;

    /// A value that must be there. @throws Error "WHERE: has no KEY"
    template <class T>
    T need(std::optional<T> value, const std::string& key) const {
        if (!value) refuseWithout(key);
        return *std::move(value);
    }

    /// @throws Error naming a key that nobody has asked for, and the nearest one that was
    void requireNoOthers() const;

    /// @throws Error "WHERE: KEY is VALUE, expected WANTED"
    [[noreturn]] void refuse(const std::string& key, const std::string& wanted) const;

private:
    const nlohmann::json* find(const std::string& key);
    [[noreturn]] void refuseWithout(const std::string& key) const;

    const nlohmann::json& object_;
    std::string where_;
    std::vector<std::string> asked_;
};

}  // namespace shadowcache
