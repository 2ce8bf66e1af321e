#pragma once

#include <string>
#include <utility>
#include <vector>

#include "bake/core/byte_stream.h"

namespace shadowcache {

/// All that a file written by a bake depends on, by name: the content of the set, options, the
/// version of the program.
using BakeIdentity = std::vector<std::pair<std::string, std::string>>;

/// What differs between two identities, in words; empty where nothing does.
std::string differences(const BakeIdentity& found, const BakeIdentity& wanted);

void put(ByteWriter& out, const BakeIdentity& identity);

/// @throws Error at the end of the bytes
BakeIdentity getIdentity(ByteReader& in);

}  // namespace shadowcache
