#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/base/option_row.h"

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
    std::optional<std::int64_t> integer(const std::string& key, std::int64_t least,
                                        std::int64_t most);
    std::optional<bool> flag(const std::string& key);
    std::optional<std::string> text(const std::string& key);
    /// One number, or as many in a list as one of `counts`.
    std::optional<std::vector<double>> numbers(const std::string& key,
                                               const std::vector<std::size_t>& counts);
    std::optional<std::vector<std::string>> texts(const std::string& key);
    std::optional<Fields> object(const std::string& key);
    /// The values of options, each under its name for requests, which are read.
    void read(std::span<const OptionRow> rows);

    bool has(const std::string& key) const;

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
