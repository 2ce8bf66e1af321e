#include "bake/app/job_identity.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <string_view>

#include "common/base/number_text.h"
#include "common/base/version.h"
#include "common/import/set_files.h"

namespace shadowcache {

namespace {

constexpr std::string_view kExtended = "extended cache";

/// Options that change items but not the places of lookups.
constexpr std::string_view kNotOfTheLookups[] = {"level", "rays",   "uniform",      "seed",
                                                 "shard", "margin", "no-transport", "no-lamps"};

/// Options that items do not depend on, or that identityOf() states by content.
constexpr std::string_view kNotOfTheItems[] = {"SET",     "output",   "stats",      "threads",
                                               "resume",  "extend",   "checkpoint", "camera",
                                               "dynamic", "progress", "memory",     "lookups"};

/// The same text for the same number: 0.25 for .25. Whole numbers may have more digits than a
/// double.
std::string asOneTypesIt(const std::string& value) {
    if (value.find_first_not_of("0123456789") == value.npos) return value;
    char* end = nullptr;
    const double number = std::strtod(value.c_str(), &end);
    return *end == '\0' ? numberText(number) : value;
}

}  // namespace

BakeIdentity identityOf(const BakeJob& job) {
    BakeIdentity identity{{"version", kVersion},
                          {"set", contentHashOf(job.files, job.mesh.references)}};
    // Where things are read from and written to is no part of it; what is read is.
    for (const auto& [name, value] : job.settings)
        if (std::ranges::find(kNotOfTheItems, name) == std::end(kNotOfTheItems))
            identity.emplace_back(name, asOneTypesIt(value));
    const CameraOptions& camera = job.shot.camera;
    identity.emplace_back("camera", camera.isFile() ? "of a file" : camera.name);
    identity.emplace_back("shot's files", contentHashOf(filesOf(job.shot), job.mesh.references));
    identity.emplace_back(kExtended, contentHashOf(std::vector{job.extend}, job.mesh.references));
    return identity;
}

BakeIdentity identityOfLookups(const BakeJob& job, const BakeIdentity& ofItems) {
    BakeIdentity identity;
    std::ranges::copy_if(ofItems, std::back_inserter(identity), [&](const auto& entry) {
        // A cache that is extended has the spacing, if none is given.
        if (entry.first == kExtended) return job.bake.spacing == 0;
        return std::ranges::find(kNotOfTheLookups, entry.first) == std::end(kNotOfTheLookups);
    });
    return identity;
}

}  // namespace shadowcache
