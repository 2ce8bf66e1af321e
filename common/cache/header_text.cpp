#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "common/cache/cache_header.h"

namespace shadowcache {

namespace {

/// Takes parts from the front of a text.
class Scanner {
public:
    explicit Scanner(std::string_view text) : rest_(text) {}

    bool take(std::string_view wanted) {
        if (!rest_.starts_with(wanted)) return false;
        rest_.remove_prefix(wanted.size());
        return true;
    }
    template <class T>
    bool number(T& value) {
        const auto parsed = std::from_chars(rest_.data(), rest_.data() + rest_.size(), value);
        if (parsed.ec != std::errc()) return false;
        rest_.remove_prefix(static_cast<std::size_t>(parsed.ptr - rest_.data()));
        return true;
    }
    bool atEnd() const { return rest_.empty(); }

private:
    std::string_view rest_;
};

/// "1-3,5/8", ascending and in range.
bool takeShards(Scanner& scan, BakeRecord& bake) {
    bake.held.clear();
    int before = -1;
    do {
        ShardRange range{};
        if (!scan.number(range.first)) return false;
        range.last = range.first;
        if (scan.take("-") && !scan.number(range.last)) return false;
        if (range.first <= before + 1 || range.last < range.first) return false;
        before = range.last;
        bake.held.push_back({range.first - 1, range.last - 1});
    } while (scan.take(","));
    return scan.take("/") && scan.number(bake.shards) && before <= bake.shards;
}

}  // namespace

std::string fingerprintText(std::uint64_t fingerprint) {
    return fmt::format("{:016x}", fingerprint);
}

std::string shapesText(const std::vector<std::uint64_t>& shapes) {
    return fmt::format("{:016x}", fmt::join(shapes, ","));
}

std::optional<std::vector<std::uint64_t>> parseShapes(std::string_view text) {
    constexpr std::size_t kDigits = 16;
    std::vector<std::uint64_t> shapes;
    for (;;) {
        if (text.size() < kDigits) return std::nullopt;
        const char* end = text.data() + kDigits;
        const auto parsed = std::from_chars(text.data(), end, shapes.emplace_back(), 16);
        if (parsed.ec != std::errc() || parsed.ptr != end) return std::nullopt;
        text.remove_prefix(kDigits);
        if (text.empty()) return shapes;
        if (text.front() != ',') return std::nullopt;
        text.remove_prefix(1);
    }
}

std::string shardsText(const std::vector<ShardRange>& shards) {
    std::string text;
    for (const auto& [first, last] : shards) {
        text += fmt::format("{}{}", text.empty() ? "" : ",", first + 1);
        if (last > first) text += fmt::format("-{}", last + 1);
    }
    return text;
}

std::vector<ShardRange> missingShards(const BakeRecord& bake) {
    std::vector<ShardRange> missing;
    int next = 0;
    for (const auto& [first, last] : bake.held) {
        if (first > next) missing.push_back({next, first - 1});
        next = last + 1;
    }
    if (next < bake.shards) missing.push_back({next, bake.shards - 1});
    return missing;
}

std::string bakesText(const std::vector<BakeRecord>& bakes) {
    std::string text;
    for (const BakeRecord& bake : bakes) {
        text += fmt::format("{}seed={} rays={}", text.empty() ? "" : "; ", bake.seed, bake.rays);
        if (!bake.whole()) text += fmt::format(" shards={}/{}", shardsText(bake.held), bake.shards);
    }
    return text;
}

std::optional<std::vector<BakeRecord>> parseBakes(std::string_view text) {
    std::vector<BakeRecord> bakes;
    if (text.empty()) return bakes;
    Scanner scan(text);
    do {
        BakeRecord bake;
        if (!scan.take("seed=") || !scan.number(bake.seed) || !scan.take(" rays=") ||
            !scan.number(bake.rays))
            return std::nullopt;
        if (scan.take(" shards=") && !takeShards(scan, bake)) return std::nullopt;
        bakes.push_back(std::move(bake));
    } while (scan.take("; "));
    if (!scan.atEnd()) return std::nullopt;
    return bakes;
}

int CacheHeader::rays() const {
    int most = 0;
    for (const BakeRecord& bake : bakes) most = std::max(most, bake.rays);
    return most;
}

std::string CacheHeader::seeds() const {
    std::string text;
    for (const BakeRecord& bake : bakes)
        text += fmt::format("{}{}", text.empty() ? "" : ",", bake.seed);
    return text;
}

}  // namespace shadowcache
