// What the study draws of the paper's importance: the triangulation of a map, the importance at a
// normal, and what tabulating the convolutions costs. Prints JSON.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <string>
#include <vector>

#include "common/base/error.h"
#include "common/base/json_file.h"
#include "common/image/image.h"
#include "common/image/radiance.h"
#include "common/random/sequence.h"
#include "render/paper/convolution.h"

namespace shadowcache {
namespace {

constexpr int kWidth = 720, kHeight = 360, kNormals = 200, kMaxLevel = 6;

/// Processor time of all threads: the machine may have other work.
double secondsSince(std::clock_t start) {
    return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

Vec3d latLong(double turn, double down) {
    const double polar = kPi * down, longitude = kPi - 2 * kPi * turn;
    return {std::sin(polar) * std::sin(longitude), std::cos(polar),
            std::sin(polar) * std::cos(longitude)};
}

Vec3d randomNormal(std::uint64_t k) {
    const double height = 1 - 2 * toUnit(hashWords(1, k)), turn = 2 * kPi * toUnit(hashWords(2, k));
    const double radius = std::sqrt(1 - height * height);
    return {radius * std::sin(turn), height, radius * std::cos(turn)};
}

/// Triangle of every direction of a lat-long picture, and what each has in it at normal `n`.
void storePicture(const Environment& environment, const std::vector<MapTriangle>& triangles,
                  const Vec3d& n, JsonFile& json) {
    std::vector<std::uint64_t> triangleOf(std::size_t{kWidth} * kHeight);
    std::vector<std::uint64_t> cells(cellCount(kMaxLevel));
    std::vector<double> importance, levels;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        const MapTriangle& t = triangles[i];
        const int shift = 2 * (kMaxLevel - t.level);
        for (std::uint32_t c = t.cell << shift; c < (t.cell + 1) << shift; ++c) cells[c] = i;
        importance.push_back(convolve(environment, t, n) / t.area);
        levels.push_back(t.level);
    }
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x)
            triangleOf[static_cast<std::size_t>(y * kWidth + x)] =
                cells[locateCell(kMaxLevel, latLong((x + 0.5) / kWidth, (y + 0.5) / kHeight))];
    json.set("width", std::uint64_t{kWidth});
    json.set("height", std::uint64_t{kHeight});
    json.set("triangle_of", triangleOf);
    json.set("importance", importance);
    json.set("level", levels);
}

/// Error of the tables against the exact convolutions, as the share of the importance that they
/// misplace, and what both cost.
void storeTableError(const Environment& environment, const std::vector<MapTriangle>& triangles,
                     JsonFile& json) {
    auto start = std::clock();
    const ConvolutionTable table(environment, triangles);
    json.set("table.seconds", secondsSince(start));
    std::vector<float> tabulated;
    std::vector<double> errors;
    double tableSeconds = 0, exactSeconds = 0;
    for (std::uint64_t k = 0; k < kNormals; ++k) {
        const Vec3d n = randomNormal(k);
        start = std::clock();
        table.evaluate(Vec3f(n), tabulated);
        tableSeconds += secondsSince(start);
        start = std::clock();
        std::vector<double> exact;
        exact.reserve(triangles.size());
        for (const MapTriangle& t : triangles) exact.push_back(convolve(environment, t, n));
        exactSeconds += secondsSince(start);
        double difference = 0, tableSum = 0, exactSum = 0;
        for (const float v : tabulated) tableSum += static_cast<double>(v);
        for (const double v : exact) exactSum += v;
        for (std::size_t i = 0; i < exact.size(); ++i)
            difference +=
                std::abs(static_cast<double>(tabulated[i]) / tableSum - exact[i] / exactSum) / 2;
        errors.push_back(difference);
    }
    json.set("table.misplaced", errors);
    json.set("table.microseconds", tableSeconds / kNormals * 1e6);
    json.set("table.exact_microseconds", exactSeconds / kNormals * 1e6);
}

/// Error of the tabulated irradiance against the exact sums, as a share of the greatest there is.
void storePreconvolutionError(const Environment& environment, JsonFile& json) {
    auto start = std::clock();
    const IrradianceTable table(environment);
    json.set("irradiance.seconds", secondsSince(start));
    const auto luminance = [&](const Rgb& c) {
        return static_cast<double>(environment.luminance(c));
    };
    std::vector<double> errors;
    double greatest = 0;
    for (std::uint64_t k = 0; k < 4 * kNormals; ++k) {
        const Vec3d n = randomNormal(k);
        const double exact = luminance(Rgb(mapIrradiance(environment, n)));
        errors.push_back(std::abs(luminance(table.evaluate(Vec3f(n))) - exact));
        greatest = std::max(greatest, exact);
    }
    for (double& error : errors) error /= greatest;
    json.set("irradiance.errors", errors);
}

}  // namespace
}  // namespace shadowcache

int main(int argc, char** argv) try {
    using namespace shadowcache;
    if (argc != 6) throw Error("wanted MAP TRIANGLES NX NY NZ");
    const RadianceImage map = readRadiance(argv[1]);
    const Environment environment(map.image, 0, map.luminanceWeights);
    const auto start = std::clock();
    const auto triangles = triangulateMap(environment, std::atoi(argv[2]), 3, kMaxLevel);
    JsonFile json;
    json.set("triangulation.seconds", secondsSince(start));
    json.set("triangulation.triangles", std::uint64_t{triangles.size()});
    storePicture(environment, triangles,
                 Vec3d(std::atof(argv[3]), std::atof(argv[4]), std::atof(argv[5])).normalized(),
                 json);
    storeTableError(environment, triangles, json);
    storePreconvolutionError(environment, json);
    std::printf("%s\n", json.text().c_str());
    return 0;
} catch (const std::exception& e) {
    std::fprintf(stderr, "shadowcache-study-importance: %s\n", e.what());
    return 1;
}
