#pragma once

#include <fmt/core.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include "common/base/suggestion.h"

namespace shadowcache {

/// "unknown key X, did you mean Y?" for the first key of an object that is not among the known
/// ones, after the name of the object; empty without one.
///
/// @param where  of the object, as "cam.lens"; may be empty
inline std::string unknownKey(const nlohmann::json& object, const std::string& where,
                              std::span<const std::string> known) {
    for (const auto& item : object.items())
        if (std::ranges::find(known, item.key()) == known.end())
            return fmt::format("unknown key {}{}{}{}", where, where.empty() ? "" : ".", item.key(),
                               suggestion(item.key(), known));
    return {};
}

}  // namespace shadowcache
