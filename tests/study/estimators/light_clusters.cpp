#include "tests/study/estimators/light_clusters.h"

#include <algorithm>

namespace shadowcache::study {

namespace {

/// Enough for the clusters of real maps to come to rest.
constexpr int kRounds = 40;

struct LitCell {
    Vec3d firstMoment;       ///< integral of luminance times direction
    Vec3d radianceIntegral;  ///< integral of the radiance
    double luminance;
};

std::vector<LitCell> litCells(const Environment& environment) {
    std::vector<LitCell> cells;
    for (std::uint32_t c = 0; c < cellCount(Environment::kLevel); ++c) {
        LitCell cell{Vec3d(0.0), Vec3d(0.0), 0};
        environment.forEachTexel(c, [&](std::uint32_t i) {
            const Environment::Texel t = environment.texel(i);
            const auto area = static_cast<double>(t.solidAngle);
            const double luminance = static_cast<double>(environment.luminance(t.radiance)) * area;
            cell.firstMoment += Vec3d(t.center) * luminance;
            cell.radianceIntegral += Vec3d(t.radiance) * area;
            cell.luminance += luminance;
        });
        if (cell.luminance > 0) cells.push_back(cell);
    }
    return cells;
}

/// Middles of parts of equal light; the cells' order keeps neighbours together.
std::vector<Vec3d> firstCenters(const std::vector<LitCell>& cells, int count) {
    double total = 0;
    for (const LitCell& cell : cells) total += cell.luminance;
    std::vector<Vec3d> centers;
    double below = 0;
    for (const LitCell& cell : cells) {
        below += cell.luminance;
        const auto made = static_cast<double>(centers.size());
        if (below >= total * (made + 0.5) / count) centers.push_back(cell.firstMoment.normalized());
    }
    return centers;
}

std::size_t nearest(const std::vector<Vec3d>& centers, const Vec3d& direction) {
    std::size_t best = 0;
    for (std::size_t k = 1; k < centers.size(); ++k)
        if (centers[k].dot(direction) > centers[best].dot(direction)) best = k;
    return best;
}

}  // namespace

std::vector<DirectionalLight> clusterLights(const Environment& environment, int count) {
    const std::vector<LitCell> cells = litCells(environment);
    std::vector<Vec3d> centers = firstCenters(cells, count);
    std::vector<Vec3d> firstMoment, radianceIntegral;
    for (int round = 0; round < kRounds; ++round) {
        firstMoment.assign(centers.size(), Vec3d(0.0));
        radianceIntegral.assign(centers.size(), Vec3d(0.0));
        for (const LitCell& cell : cells) {
            const std::size_t k = nearest(centers, cell.firstMoment);
            firstMoment[k] += cell.firstMoment;
            radianceIntegral[k] += cell.radianceIntegral;
        }
        const std::vector<Vec3d> before = centers;
        for (std::size_t k = 0; k < centers.size(); ++k)
            if (firstMoment[k].length() > 0) centers[k] = firstMoment[k].normalized();
        if (centers == before) break;
    }
    std::vector<DirectionalLight> lights;
    for (std::size_t k = 0; k < centers.size(); ++k)
        if (radianceIntegral[k] != Vec3d(0.0))
            lights.push_back({Vec3f(centers[k]), Rgb(radianceIntegral[k])});
    return lights;
}

}  // namespace shadowcache::study
