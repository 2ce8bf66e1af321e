#include "common/cache/cache_header_file.h"

#include <fmt/core.h>

#include <charconv>
#include <system_error>

#include "common/base/error.h"
#include "common/cache/cache_schema.h"
#include "common/cache/emitter_code.h"

namespace shadowcache {

namespace {

/// Largest spacing: the bake accepts no more.
constexpr double kMostMetadata = 1e12;

constexpr int kFirstFormatWithHits = 4;
constexpr int kFirstFormatWithEmitters = 5;

template <class T>
T metaValue(const openvdb::MetaMap& meta, const char* key, const std::filesystem::path& path) {
    const auto value = meta.getMetadata<openvdb::TypedMetadata<T>>(key);
    if (!value)
        throwFileError(path, std::string("a shadow cache without its metadata '") + key + "'");
    return value->value();
}

}  // namespace

openvdb::MetaMap toMetadata(const CacheHeader& header, std::size_t items) {
    openvdb::MetaMap meta;
    meta.insertMeta(kFormatKey,
                    openvdb::Int32Metadata(header.emitters.empty() ? kCacheFormatWithoutEmitters
                                                                   : kCacheFormat));
    meta.insertMeta("level", openvdb::Int32Metadata(header.level));
    meta.insertMeta("adaptive", openvdb::BoolMetadata(header.adaptive));
    meta.insertMeta("spacing", openvdb::DoubleMetadata(header.spacing));
    meta.insertMeta("bakes", openvdb::StringMetadata(bakesText(header.bakes)));
    meta.insertMeta("up_axis", openvdb::StringMetadata(header.upAxis));
    meta.insertMeta("unit", openvdb::DoubleMetadata(header.unit));
    meta.insertMeta("fingerprint", openvdb::StringMetadata(fingerprintText(header.fingerprint)));
    meta.insertMeta("version", openvdb::StringMetadata(header.version));
    if (header.part) {
        const auto count = [&](const char* key, std::uint64_t value) {
            meta.insertMeta(key, openvdb::Int64Metadata(static_cast<std::int64_t>(value)));
        };
        count("sides", header.part->sides);
        count("sides_of_set", header.part->sidesOfSet);
        meta.insertMeta("shots", openvdb::StringMetadata(header.part->shots));
    }
    meta.insertMeta("hits", openvdb::Int32Metadata(header.hits));
    if (!header.emitters.empty())
        meta.insertMeta("emitters", openvdb::StringMetadata(shapesText(header.emitters)));
    meta.insertMeta("items", openvdb::Int64Metadata(static_cast<std::int64_t>(items)));
    return meta;
}

CacheHeader fromMetadata(const openvdb::MetaMap& meta, const std::filesystem::path& path) {
    if (!meta[kFormatKey])
        throwFileError(path, "an OpenVDB file, but not a shadow cache (no 'shadowcache_format')");
    const auto format = metaValue<std::int32_t>(meta, kFormatKey, path);
    if (format < kOldestCacheFormat || format > kCacheFormat)
        throwFileError(path, fmt::format("cache format {}, this program reads {} to {}{}", format,
                                         kOldestCacheFormat, kCacheFormat,
                                         format > kCacheFormat ? " (written by a newer version)"
                                                               : ": bake the set again"));
    CacheHeader header;
    header.format = format;
    header.level = metaValue<std::int32_t>(meta, "level", path);
    header.adaptive = metaValue<bool>(meta, "adaptive", path);
    header.spacing = metaValue<double>(meta, "spacing", path);
    const auto bakes = metaValue<std::string>(meta, "bakes", path);
    if (auto parsed = parseBakes(bakes))
        header.bakes = *std::move(parsed);
    else
        throwFileError(path, "bakes '" + bakes + "', expected them as in 'seed=1 rays=16'");
    header.upAxis = metaValue<std::string>(meta, "up_axis", path);
    header.unit = metaValue<double>(meta, "unit", path);
    header.version = metaValue<std::string>(meta, "version", path);
    if (meta["shots"]) {
        const auto count = [&](const char* key) {
            return static_cast<std::uint64_t>(metaValue<std::int64_t>(meta, key, path));
        };
        header.part = {count("sides"), count("sides_of_set"),
                       metaValue<std::string>(meta, "shots", path)};
    }
    const auto print = metaValue<std::string>(meta, "fingerprint", path);
    const auto parsed =
        std::from_chars(print.data(), print.data() + print.size(), header.fingerprint, 16);
    if (parsed.ec != std::errc() || parsed.ptr != print.data() + print.size())
        throwFileError(path, "fingerprint '" + print + "', expected 16 hexadecimal digits");
    if (header.level < 0 || header.level > kMaxCacheLevel)
        throwFileError(path, fmt::format("direction level {}, expected 0 to 5", header.level));
    if (format >= kFirstFormatWithHits) header.hits = metaValue<std::int32_t>(meta, "hits", path);
    if (header.hits < 0 || header.hits > kMostHits)
        throwFileError(
            path, fmt::format("hits of {} rays an item, expected 0 to {}", header.hits, kMostHits));
    if (format >= kFirstFormatWithEmitters) {
        const auto shapes = parseShapes(metaValue<std::string>(meta, "emitters", path));
        if (!shapes || shapes->size() > kMostEmittersOfCache)
            throwFileError(path, fmt::format("emitters, expected 1 to {} of 16 hexadecimal digits",
                                             kMostEmittersOfCache));
        header.emitters = *shapes;
    }
    const auto requirePositive = [&](const char* key, double value) {
        if (!(value > 0 && value <= kMostMetadata))
            throwFileError(path,
                           fmt::format("{} {:f}, expected above 0 and at most 1e12", key, value));
    };
    requirePositive("spacing", header.spacing);
    requirePositive("unit", header.unit);
    return header;
}

}  // namespace shadowcache
