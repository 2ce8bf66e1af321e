// What the noise of importance sampling must be on a bare plane that points up, from the map alone:
// for a density that is constant over each cell and gives it the share of its light, the second
// moment of a sample over the square of its mean is the sum of A Q / (P I) over the cells, with A
// the solid angle, P the integral of L cos, Q that of its square, I the sum of P. For the triangles
// and for a grid of rectangles. Prints JSON.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <vector>

#include "common/base/error.h"
#include "common/base/json_file.h"
#include "common/image/image.h"
#include "common/image/radiance.h"
#include "render/paper/triangulation.h"

namespace shadowcache {
namespace {

constexpr int kMaxLevel = 6;

struct Cell {
    double area = 0, light = 0, square = 0;
};

/// Cells by direction.
class Triangles {
public:
    explicit Triangles(const std::vector<MapTriangle>& triangles) : of_(cellCount(kMaxLevel)) {
        for (std::uint32_t i = 0; i < triangles.size(); ++i) {
            const int shift = 2 * (kMaxLevel - triangles[i].level);
            for (auto c = triangles[i].cell << shift; c < (triangles[i].cell + 1) << shift; ++c)
                of_[c] = i;
        }
    }
    std::size_t operator()(const Vec3d& w) const { return of_[locateCell(kMaxLevel, w)]; }

private:
    std::vector<std::uint32_t> of_;
};

struct Rectangles {
    std::size_t width, height;

    std::size_t operator()(const Vec3d& w) const {
        const double turn = std::atan2(w.x, w.z) / (2 * kPi);
        const double down = std::acos(std::clamp(w.y, -1.0, 1.0)) / kPi;
        const auto x =
            static_cast<std::size_t>((turn - std::floor(turn)) * static_cast<double>(width));
        const auto y = static_cast<std::size_t>(down * static_cast<double>(height));
        return std::min(y, height - 1) * width + std::min(x, width - 1);
    }
};

/// Deviation of one sample, as a share of its mean.
template <typename CellAlong>
double noiseOf(const Environment& environment, std::size_t count, const CellAlong& cellAlong) {
    std::vector<Cell> cells(count);
    const double mean = environment.luminanceIntegral() / (4 * kPi);
    const int dullParts = environment.texelCount() < 200000 ? 4 : 1;
    for (std::size_t i = 0; i < environment.texelCount(); ++i) {
        const Environment::Texel texel = environment.texel(i);
        const auto luminance = static_cast<double>(environment.luminance(texel.radiance));
        const int parts = luminance > mean ? 8 : dullParts;
        const double area = static_cast<double>(texel.solidAngle) / (parts * parts);
        for (int k = 0; k < parts * parts; ++k) {
            const int column = k % parts, row = k / parts;
            const Vec3d w = environment.placeIn(i, (column + 0.5) / parts, (row + 0.5) / parts);
            if (w.y <= 0) continue;
            Cell& cell = cells[cellAlong(w)];
            cell.area += area;
            cell.light += luminance * w.y * area;
            cell.square += luminance * w.y * luminance * w.y * area;
        }
    }
    double light = 0, moment = 0;
    for (const Cell& cell : cells) {
        light += cell.light;
        if (cell.light > 0) moment += cell.area * cell.square / cell.light;
    }
    return std::sqrt(std::max(0.0, moment / light - 1));
}

}  // namespace
}  // namespace shadowcache

int main(int argc, char** argv) try {
    using namespace shadowcache;
    if (argc != 6) throw Error("wanted MAP DEGREES TRIANGLES WIDTH HEIGHT");
    const RadianceImage map = readRadiance(argv[1]);
    const Environment environment(map.image, std::atof(argv[2]), map.luminanceWeights);
    const auto triangles = triangulateMap(environment, std::atoi(argv[3]), 3, kMaxLevel);
    const Rectangles grid{std::strtoul(argv[4], nullptr, 10), std::strtoul(argv[5], nullptr, 10)};
    JsonFile json;
    json.set("triangles", noiseOf(environment, triangles.size(), Triangles(triangles)));
    json.set("pixels", noiseOf(environment, grid.width * grid.height, grid));
    std::printf("%s\n", json.text().c_str());
    return 0;
} catch (const std::exception& e) {
    std::fprintf(stderr, "shadowcache-study-noise: %s\n", e.what());
    return 1;
}
