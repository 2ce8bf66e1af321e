#include "bake/shot/lookup_file.h"

#include <fmt/core.h>

#include <cstdint>
#include <string>
#include <vector>

#include "bake/core/options.h"
#include "common/base/atomic_file.h"
#include "common/base/content_hash.h"
#include "common/base/error.h"
#include "common/base/file_bytes.h"
#include "common/base/number_text.h"

namespace shadowcache {

namespace {

/// A file is this, the identity, spacing, level and counts, keys and codes of the places, and a
/// checksum of all before it.
constexpr std::string_view kMagic = "Shadowcache lookups 2\n";

/// @param content  between magic and checksum
ShotLookups parse(std::string_view content, const BakeIdentity& identity) {
    ByteReader in(content);
    if (const std::string other = differences(getIdentity(in), identity); !other.empty())
        throw Error("lookups of another shot: " + other);
    ShotLookups lookups;
    lookups.spacing = in.get<double>();
    if (!(lookups.spacing > 0 && lookups.spacing <= kMostSpacing))
        throw Error("spacing " + numberText(lookups.spacing) + ", expected above 0, at most " +
                    numberText(kMostSpacing));
    lookups.level = in.get<std::int32_t>();
    if (lookups.level < 0 || lookups.level > kMaxCacheLevel)
        throw Error(fmt::format("level {}, expected 0 to {}", lookups.level, kMaxCacheLevel));
    SurfaceCount& ofSet = lookups.ofSet;
    for (std::size_t* count : {&ofSet.voxels, &ofSet.sides, &ofSet.items})
        *count = in.get<std::uint64_t>();
    const std::size_t leastVoxels = ofSet.sides / kSides + (ofSet.sides % kSides != 0);
    if (ofSet.sides < 1 || leastVoxels > ofSet.voxels)
        throw Error(fmt::format("{} sides of {} voxels, expected 1 to 6 of each", ofSet.sides,
                                ofSet.voxels));
    const auto keys = in.getVector<std::uint64_t>();
    const auto codes = in.getVector<std::uint32_t>();
    if (keys.size() != codes.size())
        throw Error(fmt::format("{} voxels of places, expected {}", keys.size(), codes.size()));
    if (!in.atEnd()) throw Error("bytes after the last place, expected none");
    std::vector<LookupPlaces::Place> places;
    places.reserve(keys.size());
    for (std::size_t i = 0; i < keys.size(); ++i) {
        places.push_back({keys[i], codes[i]});
        if (!places.back().isValid())
            throw Error(
                fmt::format("place {} is {}, {}, which no bake writes", i, keys[i], codes[i]));
    }
    lookups.places.add(std::move(places));
    return lookups;
}

}  // namespace

void writeLookups(const std::filesystem::path& path, const BakeIdentity& identity,
                  const ShotLookups& lookups) {
    std::vector<std::uint64_t> keys;
    std::vector<std::uint32_t> codes;
    for (const LookupPlaces::Place& place : lookups.places.places()) {
        keys.push_back(place.voxelKey);
        codes.push_back(place.code);
    }
    ByteWriter out;
    put(out, identity);
    out.put(lookups.spacing);
    out.put(std::int32_t{lookups.level});
    for (const std::size_t count : {lookups.ofSet.voxels, lookups.ofSet.sides, lookups.ofSet.items})
        out.put(std::uint64_t{count});
    out.put(keys);
    out.put(codes);
    writeWhole(path, sealed(std::string(kMagic) + out.take()));
}

ShotLookups readLookups(const std::filesystem::path& path, const BakeIdentity& identity) {
    const std::string bytes = readFileBytes(path);
    if (!bytes.starts_with(kMagic))
        throwFileError(path, "not a lookups file, expected one of shadowcache-bake --lookups-only");
    const auto content = unsealed(bytes);
    if (!content || !content->starts_with(kMagic))
        throwFileError(path, "damaged: its checksum differs; make it again by --lookups-only");
    try {
        return parse(content->substr(kMagic.size()), identity);
    } catch (const Error& e) {
        throwFileError(path, e.what());
    }
}

}  // namespace shadowcache
