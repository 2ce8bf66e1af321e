#include "bake/core/bake_identity.h"

#include <algorithm>
#include <cstdint>
#include <string_view>

namespace shadowcache {

std::string differences(const BakeIdentity& found, const BakeIdentity& wanted) {
    std::string text;
    const auto valueIn = [](const BakeIdentity& identity, const std::string& name) {
        const auto entry = std::ranges::find(identity, name, &BakeIdentity::value_type::first);
        return entry == identity.end() ? std::string("none") : entry->second;
    };
    const auto add = [&](const std::string& name) {
        const std::string has = valueIn(found, name), needs = valueIn(wanted, name);
        if (has != needs)
            text += (text.empty() ? "" : "; ") + name + " " + has + ", expected " + needs;
    };
    for (const auto& [name, value] : wanted) add(name);
    for (const auto& [name, value] : found)
        if (std::ranges::find(wanted, name, &BakeIdentity::value_type::first) == wanted.end())
            add(name);
    return text;
}

void put(ByteWriter& out, const BakeIdentity& identity) {
    out.put(std::uint64_t{identity.size()});
    for (const auto& [name, value] : identity) {
        out.put(std::string_view(name));
        out.put(std::string_view(value));
    }
}

BakeIdentity getIdentity(ByteReader& in) {
    BakeIdentity identity;
    for (auto left = in.get<std::uint64_t>(); left > 0; --left) {
        std::string name(in.getText());
        identity.emplace_back(std::move(name), in.getText());
    }
    return identity;
}

}  // namespace shadowcache
