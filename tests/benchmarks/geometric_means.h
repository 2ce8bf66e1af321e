#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <string>

#include "tests/benchmarks/bench.h"

namespace shadowcache::bench {

/// Of logarithms, under several names.
class GeometricMeans {
public:
    void add(const std::string& name, double value) {
        Entry& entry = entries_[name];
        entry.logSum += std::log(value);
        entry.least = entry.count == 0 ? value : std::min(entry.least, value);
        ++entry.count;
    }

    /// @param key  of the JSON file, above the names
    void print(const char* what, const std::string& key, JsonFile& json) const {
        for (const auto& [name, entry] : entries_) {
            const double mean = std::exp(entry.logSum / entry.count);
            std::printf("%s, %s: geometric mean %.2f, least %.2f of %d\n", what, name.c_str(), mean,
                        entry.least, entry.count);
            json.set("summary." + key + "." + name + ".geometric_mean", mean);
            json.set("summary." + key + "." + name + ".least", entry.least);
        }
    }

private:
    struct Entry {
        double logSum = 0, least = 0;
        int count = 0;
    };
    std::map<std::string, Entry> entries_;
};

}  // namespace shadowcache::bench
