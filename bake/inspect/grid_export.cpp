#include "bake/inspect/grid_export.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <functional>
#include <string_view>

#include "bake/inspect/bounced_light.h"
#include "bake/inspect/sky_light.h"
#include "common/base/error.h"
#include "common/base/parallel.h"
#include "common/base/suggestion.h"
#include "common/image/radiance.h"

namespace shadowcache {

namespace {

/// What the grids that show one side of each voxel are made of.
struct Source {
    const CacheHeader& header;
    const CacheItems& items;
    const VoxelRuns& runs;
    double environmentRotation;
    const std::filesystem::path& cache;
};

/// What an item sees of the sky.
struct SkySight {
    double visibility = 0;      ///< visible share of the counted directions
    Vec3d bentNormal{0, 0, 0};  ///< integral of the visible directions, not normalised
    double above = 0;           ///< visible above the world's horizon [sr]
};

class SkyMeter {
public:
    SkyMeter() {
        for (int level = 0; level <= kMaxCacheLevel; ++level)
            for (std::uint32_t cell = 0; cell < cellCount(level); ++cell)
                cells_[static_cast<std::size_t>(level)].push_back(
                    {cellCenter(level, cell), solidAngle(cellTriangle(level, cell))});
    }

    SkySight measure(const std::vector<CountedRegion>& regions) const {
        SkySight sight;
        double area = 0;
        for (const CountedRegion& region : regions) {
            const Cell& cell = cells_[static_cast<std::size_t>(region.level)][region.cell];
            const double visible = cell.solidAngle * region.share();
            sight.bentNormal += cell.center * visible;
            sight.visibility += visible;
            if (cell.center.y > 0) sight.above += visible;
            area += cell.solidAngle;
        }
        if (area > 0) sight.visibility /= area;
        return sight;
    }

private:
    struct Cell {
        Vec3d center;
        double solidAngle;
    };
    std::array<std::vector<Cell>, kMaxCacheLevel + 1> cells_;
};

/// Value of an item, given its regions and what it sees of the sky.
using ItemValue = std::function<Vec3f(ItemRegions&, const SkySight&, std::size_t item)>;

/// A voxel shows the side that sees most of the upper sky, not the inside of a solid or the
/// underside of the ground.
VolumeGrid bestOfSides(const GridRequest& request, VolumeKind kind, const Source& source,
                       const ItemValue& valueOf) {
    VolumeGrid grid{request.name, kind, std::vector<Vec3f>(source.runs.voxels.size(), Vec3f(0))};
    const SkyMeter meter;
    parallelFor(grid.values.size(), 256, [&](const Chunk& chunk) {
        ItemRegions regions(source.header.tiers());
        for (std::size_t v = chunk.begin; v < chunk.end; ++v) {
            std::size_t best = source.runs.firstItem[v];
            SkySight widest{0, Vec3d(0), -1};
            for (std::size_t i = best; i < source.runs.firstItem[v + 1]; ++i) {
                regions.use(source.items, i);
                const SkySight sight = meter.measure(regions.finest());
                if (sight.above <= widest.above) continue;
                widest = sight;
                best = i;
            }
            regions.use(source.items, best);
            grid.values[v] = valueOf(regions, widest, best);
        }
    });
    return grid;
}

VolumeGrid makeSkyVisibility(const GridRequest& request, const Source& source) {
    return bestOfSides(request, VolumeKind::fog, source,
                       [](ItemRegions&, const SkySight& sight, std::size_t) {
                           return Vec3f(static_cast<float>(sight.visibility));
                       });
}

VolumeGrid makeBentNormal(const GridRequest& request, const Source& source) {
    return bestOfSides(request, VolumeKind::direction, source,
                       [](ItemRegions&, const SkySight& sight, std::size_t) {
                           const double length = sight.bentNormal.length();
                           return length > 0 ? Vec3f(sight.bentNormal / length) : Vec3f(0);
                       });
}

/// 1 less the mean standard deviation of a ray's answer, in units of the greatest there can be.
VolumeGrid makeConfidence(const GridRequest& request, const Source& source) {
    return bestOfSides(
        request, VolumeKind::fog, source, [](ItemRegions& regions, const SkySight&, std::size_t) {
            double uncertainty = 0, area = 0;
            for (const CountedRegion& r : regions.finest()) {
                const double solidAngle = 1.0 / cellCount(r.level);  // of the sphere, about
                uncertainty += solidAngle * 2 * std::sqrt(r.posterior * (1 - r.posterior));
                area += solidAngle;
            }
            return Vec3f(area > 0 ? static_cast<float>(1 - uncertainty / area) : 0.0f);
        });
}

/// Of all sides that face the direction, the mean.
VolumeGrid makeDirection(const GridRequest& request, const Source& source) {
    Vec3d direction;
    char rest = 0;
    if (std::sscanf(request.argument.c_str(), "%lf,%lf,%lf%c", &direction.x, &direction.y,
                    &direction.z, &rest) != 3 ||
        !(direction.length() > 0) || !std::isfinite(direction.length()))
        throw Error("--export-grid direction=" + request.argument +
                    ": expected a direction, as in direction=0,1,0");
    const std::uint32_t cell = locateCell(kMaxCacheLevel, direction.normalized());
    VolumeGrid grid{request.name, VolumeKind::fog, {}};
    ItemRegions regions(source.header.tiers());
    for (std::size_t v = 0; v < source.runs.voxels.size(); ++v) {
        double visible = 0, counted = 0;
        for (std::size_t i = source.runs.firstItem[v]; i < source.runs.firstItem[v + 1]; ++i) {
            regions.use(source.items, i);
            const CountedRegion r = regions.along(cell);
            if (r.d == 0) continue;
            const double weight =
                static_cast<double>(shareOf(PatchCode::of(source.items.patch[i]).subpatch));
            visible += weight * r.share();
            counted += weight;
        }
        grid.values.emplace_back(counted > 0 ? static_cast<float>(visible / counted) : 0.0f);
    }
    return grid;
}

Environment readEnvironment(const GridRequest& request, const Source& source) {
    if (request.argument.empty())
        throw Error("--export-grid " + request.kind + ": expected a map, as in " + request.kind +
                    "=sky.exr");
    const RadianceImage map = readRadiance(request.argument);
    for (const std::string& note : map.notes)
        std::fprintf(stderr, "shadowcache-info: warning: %s: %s\n", request.argument.c_str(),
                     note.c_str());
    return {map.image, source.environmentRotation, map.luminanceWeights};
}

VolumeGrid makeEnvironment(const GridRequest& request, const Source& source) {
    const Environment sky = readEnvironment(request, source);
    return bestOfSides(request, VolumeKind::fog, source,
                       [&](ItemRegions& regions, const SkySight&, std::size_t i) {
                           const SkyLight light =
                               skyLight(regions.finest(), source.items.normal[i], sky);
                           const float all = sky.luminance(light.unshadowed);
                           const float seen = sky.luminance(light.seen);
                           return Vec3f(all > 0 ? std::min(1.0f, seen / all) : 0.0f);
                       });
}

VolumeGrid makeIrradiance(const GridRequest& request, const Source& source) {
    const Environment sky = readEnvironment(request, source);
    return bestOfSides(request, VolumeKind::color, source,
                       [&](ItemRegions& regions, const SkySight&, std::size_t i) {
                           const Rgb seen =
                               skyLight(regions.finest(), source.items.normal[i], sky).seen;
                           return Vec3f(seen.x, seen.y, seen.z);
                       });
}

VolumeGrid makeBouncedIrradiance(const GridRequest& request, const Source& source) {
    const std::vector<Rgb> irradiance =
        bouncedIrradiance(source.cache, source.items, readEnvironment(request, source));
    return bestOfSides(request, VolumeKind::color, source,
                       [&](ItemRegions&, const SkySight&, std::size_t i) {
                           return Vec3f(irradiance[i].x, irradiance[i].y, irradiance[i].z);
                       });
}

VolumeGrid makeSurface(const GridRequest& request, const Source& source) {
    return {request.name, VolumeKind::fog, std::vector<Vec3f>(source.runs.voxels.size(), Vec3f(1))};
}

struct Kind {
    const char* word;
    const char* gridName;
    const char* example;
    const char* summary;
    VolumeGrid (*make)(const GridRequest&, const Source&);
};

constexpr Kind kKinds[] = {
    {"openness", "openness", "openness", "visible share of the sky (fog volume)",
     makeSkyVisibility},
    {"mean-direction", "open_direction", "mean-direction",
     "unit vector to the middle of the visible sky (Vec3s)", makeBentNormal},
    {"confidence", "confidence", "confidence",
     "how sure the counts are of a ray's answer, 0 to 1 (fog volume)", makeConfidence},
    {"surface", "surface", "surface", "1 in every voxel, to divide the others by (fog volume)",
     makeSurface},
    {"direction", "direction_visibility", "direction=X,Y,Z",
     "visible share toward one direction (fog volume)", makeDirection},
    {"env", "env_visibility", "env=MAP", "visible share of a map's light (fog volume)",
     makeEnvironment},
    {"irradiance", "irradiance", "irradiance=MAP", "light of a map that arrives (Vec3s colour)",
     makeIrradiance},
    {"bounced-irradiance", "bounced_irradiance", "bounced-irradiance=MAP",
     "the same with the light that bounces off surfaces of albedo 1/2 (Vec3s colour)",
     makeBouncedIrradiance},
};

const Kind& findKind(const std::string& word) {
    const Kind* found = std::find_if(std::begin(kKinds), std::end(kKinds),
                                     [&](const Kind& kind) { return word == kind.word; });
    if (found == std::end(kKinds))
        throw Error("--export-grid " + word + ": no such grid" + suggestion(word, gridKinds()) +
                    " (see --help)");
    return *found;
}

}  // namespace

std::string gridKindsHelp() {
    std::string help;
    for (const Kind& kind : kKinds)
        help += std::string("\n  ") + kind.example + ": " + kind.summary;
    return help;
}

const std::vector<std::string>& gridKinds() {
    static const std::vector<std::string> words = [] {
        std::vector<std::string> all;
        for (const Kind& kind : kKinds) all.emplace_back(kind.word);
        return all;
    }();
    return words;
}

GridRequest parseGridRequest(const std::string& spec) {
    const std::size_t equals = spec.find('=');
    const std::string words = spec.substr(0, equals);
    const std::size_t colon = words.find(':');
    const std::string name = colon == words.npos ? "" : words.substr(0, colon);
    const std::string kind = colon == words.npos ? words : words.substr(colon + 1);
    const auto isWord = [](const std::string& word, const char* also) {
        return std::ranges::all_of(word, [&](char c) {
            return std::isalnum(static_cast<unsigned char>(c)) ||
                   std::string_view(also).find(c) != std::string_view::npos;
        });
    };
    if (kind.empty() || !isWord(kind, "_-") || colon == 0 || !isWord(name, "_"))
        throw Error("--export-grid " + spec + ": expected [NAME:]KIND[=ARGUMENT]");
    const char* usual = findKind(kind).gridName;
    return {name.empty() ? usual : name, kind, equals == spec.npos ? "" : spec.substr(equals + 1)};
}

VolumeGrid makeVolumeGrid(const GridRequest& request, double environmentRotation,
                          const CacheHeader& header, const CacheItems& items, const VoxelRuns& runs,
                          const std::filesystem::path& cache) {
    return findKind(request.kind).make(request, {header, items, runs, environmentRotation, cache});
}

void exportGrids(const std::vector<GridRequest>& requests, double environmentRotation,
                 const CacheHeader& header, const CacheItems& items,
                 const std::filesystem::path& cache, const std::filesystem::path& path) {
    const VoxelRuns runs = findVoxels(items);
    std::vector<VolumeGrid> grids;
    for (const GridRequest& request : requests) {
        for (const VolumeGrid& other : grids)
            if (other.name == request.name)
                throw Error("--export-grid: two grids named " + request.name +
                            "; give one another name, as in second:" + request.kind);
        grids.push_back(makeVolumeGrid(request, environmentRotation, header, items, runs, cache));
    }
    writeVolumes(path, header, runs.voxels, grids);
}

}  // namespace shadowcache
