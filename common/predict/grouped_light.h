#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "common/math/vec.h"

namespace shadowcache {

/// Light of places, that of each light group apart. Empty where no groups are asked for.
class GroupedLight {
public:
    GroupedLight() = default;
    /// Black.
    GroupedLight(std::size_t places, std::size_t groups) { assign(places, groups); }

    /// Becomes black, for so many places. Memory is used again.
    void assign(std::size_t places, std::size_t groups) {
        groups_ = groups;
        values_.assign(places * groups, Rgb(0, 0, 0));
    }

    bool empty() const { return values_.empty(); }
    std::size_t groups() const { return groups_; }

    /// Of one place, by group.
    std::span<Rgb> operator[](std::size_t place) {
        return std::span(values_).subspan(place * groups_, groups_);
    }
    std::span<const Rgb> operator[](std::size_t place) const {
        return std::span(values_).subspan(place * groups_, groups_);
    }

    /// Copies the light of `count` places, which those of `from` have from `first` on.
    static GroupedLight part(const GroupedLight& from, std::size_t first, std::size_t count) {
        GroupedLight light;
        light.groups_ = from.groups_;
        if (from.empty()) return light;
        const auto begin = from.values_.begin() + static_cast<std::ptrdiff_t>(first * from.groups_);
        light.values_.assign(begin, begin + static_cast<std::ptrdiff_t>(count * from.groups_));
        return light;
    }

private:
    std::size_t groups_ = 0;
    std::vector<Rgb> values_;
};

/// Adds the light of a place, each group's times a factor.
inline void addTo(std::span<Rgb> sum, std::span<const Rgb> light, const Rgb& factor) {
    for (std::size_t g = 0; g < sum.size(); ++g) sum[g] += light[g] * factor;
}

}  // namespace shadowcache
