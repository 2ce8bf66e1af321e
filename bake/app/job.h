#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bake/core/options.h"
#include "bake/core/partial_cache.h"
#include "bake/shot/shot_source.h"
#include "common/import/mesh_options.h"
#include "common/mesh/mesh.h"

namespace shadowcache {

/// One run of shadowcache-bake, as its command line asks.
struct BakeJob {
    std::vector<std::filesystem::path> files;
    std::filesystem::path output;
    std::filesystem::path stats;
    std::filesystem::path extend;   ///< cache to add to; empty: none
    std::filesystem::path lookups;  ///< file that has the shot's lookups; empty: find them
    MeshOptions mesh;
    BakeOptions bake;
    /// In place of bake.spacing: times the one that is chosen, above 0.
    std::optional<double> chosenSpacings;
    bool isLevelGiven = false;  ///< bake.level is; else it is chosen with the spacing
    ShotOptions shot;           ///< without a camera: the bake is of the whole set
    int threads = 0;
    bool estimate = false;     ///< predict what the bake takes, write no cache
    bool lookupsOnly = false;  ///< write the shot's lookups, and no cache
    bool resume = false;
    double checkpointSeconds = 30;
    std::uint64_t memory = 0;  ///< bytes of finished items to keep until the end; 0: all
    std::vector<std::pair<std::string, std::string>> settings;  ///< as ParsedLine has them
};

/// Refuses invalid options before the long work starts. @throws Error
void validate(const BakeJob& job);

/// What a program that does more than the bake has in common with it.
struct BakeCompany {
    const TriangleMesh* mesh = nullptr;  ///< the job's set, if it is loaded; null: it is read
    PartialCache* partial = nullptr;     ///< gets what is finished so far; null: nobody wants it
};

/// Runs the job. @throws Error
void run(const BakeJob& job, const BakeCompany& company = {});

}  // namespace shadowcache
