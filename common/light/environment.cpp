#include "common/light/environment.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "common/base/error.h"
#include "common/base/parallel.h"
#include "common/base/tuned.h"

namespace shadowcache {

namespace {

/// Smaller maps are replicated to this size, so that cells hold whole texels and a step in
/// longitude is small enough for the series in finishDraw().
constexpr std::size_t kMinWidth = 1024;
constexpr std::size_t kMinHeight = 512;
/// Texels within a cell are kept in the order of this finer level, so that strata of the cumulative
/// sum are compact in direction.
SHADOWCACHE_TUNED(int, kOrderLevel, 8);
constexpr double kTwoPi = 2 * kPi;
/// Where the dark texels at the end of a cell begin: past every step that is drawn.
constexpr std::uint32_t kNoStep = 0xffffffffu;

std::size_t index(std::uint32_t i) {
    return static_cast<std::size_t>(i);
}

/// Integrals of the direction and of its products xx, yy, zz, xy, xz, yz over the lat-long
/// rectangle of polar angles [t0, t1] and longitudes [p0, p1], and its solid angle.
struct RectangleMoment {
    Vec3d vector;
    std::array<double, 6> second;
    double solidAngle;
};
RectangleMoment integrateRectangle(double t0, double t1, double p0, double p1) {
    const double sin2 = (t1 - t0) / 2 - (std::sin(2 * t1) - std::sin(2 * t0)) / 4;
    const double sinCos = (std::sin(t1) * std::sin(t1) - std::sin(t0) * std::sin(t0)) / 2;
    const auto cube = [](double x) { return x * x * x; };
    const double cosines = std::cos(t0) - std::cos(t1), width = p1 - p0;
    const double sineSum = std::cos(p0) - std::cos(p1), cosineSum = std::sin(p1) - std::sin(p0);
    const double cos2Sin = (cube(std::cos(t0)) - cube(std::cos(t1))) / 3;
    const double sin3 = cosines - cos2Sin;
    const double sin2Cos = (cube(std::sin(t1)) - cube(std::sin(t0))) / 3;
    const double wobble = (std::sin(2 * p1) - std::sin(2 * p0)) / 4;
    const double mixed = (std::sin(p1) * std::sin(p1) - std::sin(p0) * std::sin(p0)) / 2;
    return {{sin2 * sineSum, sinCos * width, sin2 * cosineSum},
            {sin3 * (width / 2 - wobble), cos2Sin * width, sin3 * (width / 2 + wobble),
             sin2Cos * sineSum, sin3 * mixed, sin2Cos * cosineSum},
            cosines * width};
}

}  // namespace

Environment::Environment(const Image& map, double rotationDegrees, const Rgb& luminanceWeights)
    : rotation_(rotationDegrees * kPi / 180), luminanceWeights_(luminanceWeights) {
    if (map.width < 1 || map.height < 1) throw Error("environment map: it has no texels");
    const auto mapWidth = static_cast<std::size_t>(map.width);
    const auto mapHeight = static_cast<std::size_t>(map.height);
    const std::size_t repeatX = (kMinWidth + mapWidth - 1) / mapWidth;
    const std::size_t repeatY = (kMinHeight + mapHeight - 1) / mapHeight;
    width_ = mapWidth * repeatX;
    height_ = mapHeight * repeatY;
    if (width_ * height_ > std::size_t{1} << 31)
        throw Error(fmt::format("environment map: {}x{} texels, at most 2^31 are supported",
                                map.width, map.height));
    map_.resize(width_ * height_);
    for (std::size_t y = 0; y < height_; ++y)
        for (std::size_t x = 0; x < width_; ++x)
            map_[y * width_ + x] = {map.pixels[(y / repeatY) * mapWidth + x / repeatX], 0};

    rowCos_.resize(height_ + 1);
    for (std::size_t y = 0; y <= height_; ++y)
        rowCos_[y] = static_cast<float>(
            std::cos(kPi * static_cast<double>(y) / static_cast<double>(height_)));
    columnCos_.resize(width_);
    columnSin_.resize(width_);
    for (std::size_t x = 0; x < width_; ++x) {
        const double longitude =
            kPi - kTwoPi * static_cast<double>(x) / static_cast<double>(width_) + rotation_;
        columnCos_[x] = static_cast<float>(std::cos(longitude));
        columnSin_[x] = static_cast<float>(std::sin(longitude));
    }
    sortTexels();
    sumCells();
    tabulate();
    tabulateDensity();
}

void Environment::sortTexels() {
    const std::size_t count = width_ * height_;
    std::vector<std::uint32_t> keys(count);
    parallelFor(height_, 8, [&](const Chunk& rows) {
        for (std::size_t y = rows.begin; y < rows.end; ++y) {
            const double polar =
                kPi * (static_cast<double>(y) + 0.5) / static_cast<double>(height_);
            for (std::size_t x = 0; x < width_; ++x) {
                const double longitude =
                    kPi + rotation_ -
                    kTwoPi * (static_cast<double>(x) + 0.5) / static_cast<double>(width_);
                keys[y * width_ + x] =
                    locateCell(kOrderLevel, {std::sin(polar) * std::sin(longitude), std::cos(polar),
                                             std::sin(polar) * std::cos(longitude)});
            }
        }
    });
    const int shift = 2 * (kOrderLevel - kLevel);
    firstTexel_.assign(cellCount(kLevel) + 1, 0);
    for (const std::uint32_t key : keys) ++firstTexel_[index(key >> shift) + 1];
    for (std::size_t i = 1; i < firstTexel_.size(); ++i) firstTexel_[i] += firstTexel_[i - 1];
    sorted_.resize(count);
    texelBegin_.resize(count);
    std::vector<std::uint32_t> next(firstTexel_.begin(), firstTexel_.end() - 1);
    for (std::size_t i = 0; i < count; ++i)
        sorted_[next[keys[i] >> shift]++] = {map_[i].radiance, static_cast<std::uint32_t>(i)};
    parallelFor(cellCount(kLevel), 64, [&](const Chunk& cells) {
        for (std::size_t c = cells.begin; c < cells.end; ++c)
            std::sort(sorted_.begin() + firstTexel_[c], sorted_.begin() + firstTexel_[c + 1],
                      [&](const SortedTexel& a, const SortedTexel& b) {
                          return std::pair(keys[a.index], a.index) <
                                 std::pair(keys[b.index], b.index);
                      });
    });
}

void Environment::sumCells() {
    const std::size_t cellTotal = cellCount(kLevel);
    luminance_[kLevel].assign(cellTotal, 0.0);
    sums_[kLevel].assign(cellTotal, {});
    parallelFor(cellTotal, 64, [&](const Chunk& cells) {
        std::vector<double> weights;
        for (std::size_t c = cells.begin; c < cells.end; ++c) {
            const std::uint32_t first = firstTexel_[c], last = firstTexel_[c + 1];
            weights.assign(last - first, 0.0);
            for (std::uint32_t i = first; i < last; ++i) {
                const std::size_t y = sorted_[i].index / width_, x = sorted_[i].index % width_;
                const double dy = kPi / static_cast<double>(height_);
                const double dx = kTwoPi / static_cast<double>(width_);
                const double right = kPi + rotation_ - dx * static_cast<double>(x);
                const RectangleMoment m =
                    integrateRectangle(dy * static_cast<double>(y), dy * static_cast<double>(y + 1),
                                       right - dx, right);
                const Rgb& radiance = sorted_[i].radiance;
                for (unsigned k = 0; k < 3; ++k) {
                    const auto light = static_cast<double>(radiance[static_cast<int>(k)]);
                    sums_[kLevel][c].firstMoment[k] += m.vector * light;
                    for (std::size_t j = 0; j < 6; ++j)
                        sums_[kLevel][c].second[k][j] += m.second[j] * light;
                }
                weights[i - first] = static_cast<double>(luminance(radiance)) * m.solidAngle;
                luminance_[kLevel][c] += weights[i - first];
            }
            accumulate(c, weights);
        }
    });
    for (int level = kLevel - 1; level >= 0; --level) {
        const auto l = static_cast<std::size_t>(level);
        luminance_[l].assign(cellCount(level), 0.0);
        sums_[l].assign(cellCount(level), {});
        for (std::size_t c = 0; c < cellCount(level); ++c)
            for (std::size_t child = 4 * c; child < 4 * c + 4; ++child) {
                luminance_[l][c] += luminance_[l + 1][child];
                for (std::size_t k = 0; k < 3; ++k) {
                    sums_[l][c].firstMoment[k] += sums_[l + 1][child].firstMoment[k];
                    for (std::size_t j = 0; j < 6; ++j)
                        sums_[l][c].second[k][j] += sums_[l + 1][child].second[k][j];
                }
            }
    }
    sphereLuminance_ = 0;
    for (const double p : luminance_[0]) sphereLuminance_ += p;
}

void Environment::accumulate(std::size_t cell, const std::vector<double>& weights) {
    // Every lit texel owns at least one of the cell's 2^32 steps, and its density is that of the
    // steps it owns, so none is lost beside a sun. Dark texels own none: they begin where the next
    // lit one does, those after the last lit one at the very end.
    const auto lit = static_cast<double>(
        std::count_if(weights.begin(), weights.end(), [](double w) { return w > 0; }));
    const double steps = (4294967294.0 - lit) * (1 - 1e-12);
    std::uint64_t sum = 0;
    std::uint32_t end = firstTexel_[cell];  // after the last lit texel
    for (std::uint32_t i = firstTexel_[cell]; i < firstTexel_[cell + 1]; ++i) {
        texelBegin_[i] = static_cast<std::uint32_t>(sum);
        const double w = weights[i - firstTexel_[cell]];
        if (!(w > 0)) continue;
        sum += 1 + static_cast<std::uint64_t>(steps * (w / luminance_[kLevel][cell]));
        end = i + 1;
    }
    for (std::uint32_t i = end; i < firstTexel_[cell + 1]; ++i) texelBegin_[i] = kNoStep;
}

void Environment::tabulate() {
    const double texelRadius =
        0.5 * kPi *
        std::hypot(1.0 / static_cast<double>(height_), 2.0 / static_cast<double>(width_));
    for (int level = 0; level <= kLevel; ++level) {
        const auto l = static_cast<std::size_t>(level);
        moments_[l].assign((cellCount(level) + 15) / 16, CellMoments{});
        for (std::uint32_t c = 0; c < cellCount(level); ++c) {
            CellMoments& m = moments_[l][c / 16];
            const std::size_t i = c % 16;
            const CellCap cap = cellCap(level, c);
            const double radius = cap.angle + texelRadius + 1e-6;
            for (std::size_t k = 0; k < 3; ++k) {
                m.axis[k][i] = static_cast<float>(cap.axis[static_cast<int>(k)]);
                for (std::size_t j = 0; j < 3; ++j)
                    m.firstMoment[k][j][i] =
                        static_cast<float>(sums_[l][c].firstMoment[k][static_cast<int>(j)]);
                for (std::size_t j = 0; j < 6; ++j)
                    m.second[k][j][i] = static_cast<float>(sums_[l][c].second[k][j]);
            }
            m.sinRadius[i] = static_cast<float>(std::sin(radius));
            m.luminanceIntegral[i] = static_cast<float>(luminance_[l][c]);
        }
    }
    // Lit cells keep a chance that survives the rounding of the running sum beside a very bright
    // one.
    const std::vector<double>& cells = luminance_[kLevel];
    cellCdf_.assign(cells.size() + 1, 0.0);
    for (std::size_t c = 0; c < cells.size(); ++c)
        cellCdf_[c + 1] = cellCdf_[c] + (cells[c] > 0 ? cells[c] + 1e-13 * sphereLuminance_ : 0.0);
    // guide_[g] is the cell in which the g-th of equal parts of the running sum begins.
    guide_.assign(cells.size() + 1, static_cast<std::uint32_t>(cells.size() - 1));
    std::uint32_t c = 0;
    for (std::size_t g = 0; g + 1 < guide_.size(); ++g) {
        const double x =
            cellCdf_.back() * static_cast<double>(g) / static_cast<double>(guide_.size() - 1);
        while (c + 1 < cells.size() && cellCdf_[c + 1] <= x) ++c;
        guide_[g] = c;
    }
}

double Environment::luminanceIntegral(int level, std::uint32_t cell) const noexcept {
    return luminance_[static_cast<std::size_t>(level)][cell];
}

double Environment::texelShare(std::uint32_t rank, std::uint32_t cellEnd) const noexcept {
    const std::uint32_t next = rank + 1 < cellEnd ? texelBegin_[rank + 1] : kNoStep;
    const std::uint64_t end = next == kNoStep ? std::uint64_t{1} << 32 : std::uint64_t{next};
    return static_cast<double>(end - texelBegin_[rank]) * 0x1p-32;
}

void Environment::tabulateDensity() {
    parallelFor(cellCount(kLevel), 64, [&](const Chunk& cells) {
        for (std::size_t c = cells.begin; c < cells.end; ++c) {
            const auto texels = texelsOf(static_cast<std::uint32_t>(c));
            const double cellShare = (cellCdf_[c + 1] - cellCdf_[c]) / cellCdf_.back();
            for (std::uint32_t i = texels[0]; i < texels[1]; ++i)
                if (luminance(sorted_[i].radiance) > 0)
                    map_[sorted_[i].index].density =
                        static_cast<float>(cellShare * texelShare(i, texels[1]) /
                                           static_cast<double>(texel(i).solidAngle));
        }
    });
}

std::size_t Environment::texelAlong(const Vec3f& direction) const noexcept {
    float turn = (static_cast<float>(kPi + rotation_) - std::atan2(direction.x, direction.z)) *
                 static_cast<float>(1 / kTwoPi);
    turn -= std::floor(turn);
    const float polar =
        std::acos(std::clamp(direction.y, -1.0f, 1.0f)) * static_cast<float>(1 / kPi);
    const auto x = static_cast<std::size_t>(turn * static_cast<float>(width_));
    const auto y = static_cast<std::size_t>(polar * static_cast<float>(height_));
    return std::min(y, height_ - 1) * width_ + std::min(x, width_ - 1);
}

Rgb Environment::radiance(const Vec3f& direction) const noexcept {
    return map_[texelAlong(direction)].radiance;
}

EnvironmentSample Environment::lookUp(const Vec3f& direction) const noexcept {
    const std::size_t i = texelAlong(direction);
    return {direction, map_[i].radiance, map_[i].density, 0, static_cast<std::uint32_t>(i)};
}

Environment::Texel Environment::texel(std::size_t i) const noexcept {
    const std::size_t y = sorted_[i].index / width_, x = sorted_[i].index % width_;
    const double polar = kPi * (static_cast<double>(y) + 0.5) / static_cast<double>(height_);
    const double longitude =
        kPi + rotation_ - kTwoPi * (static_cast<double>(x) + 0.5) / static_cast<double>(width_);
    return {
        Vec3f(static_cast<float>(std::sin(polar) * std::sin(longitude)),
              static_cast<float>(std::cos(polar)),
              static_cast<float>(std::sin(polar) * std::cos(longitude))),
        sorted_[i].radiance,
        static_cast<float>(kTwoPi / static_cast<double>(width_)) * (rowCos_[y] - rowCos_[y + 1]),
        sorted_[i].index};
}

Vec3d Environment::placeIn(std::size_t i, double x, double y) const noexcept {
    const std::size_t row = sorted_[i].index / width_, column = sorted_[i].index % width_;
    const auto top = static_cast<double>(rowCos_[row]),
               bottom = static_cast<double>(rowCos_[row + 1]);
    const double cosPolar = top + (bottom - top) * y;
    const double sinPolar = std::sqrt(std::max(0.0, 1 - cosPolar * cosPolar));
    const double longitude =
        kPi + rotation_ - kTwoPi * (static_cast<double>(column) + x) / static_cast<double>(width_);
    return {sinPolar * std::sin(longitude), cosPolar, sinPolar * std::cos(longitude)};
}

float Environment::maxLuminance(const Vec3d& axis, double angle) const noexcept {
    const double polar = std::acos(std::clamp(axis.y, -1.0, 1.0));
    const auto row = [&](double p) {
        const double y = std::clamp(p / kPi, 0.0, 1.0) * static_cast<double>(height_);
        return std::min(static_cast<std::size_t>(y), height_ - 1);
    };
    const bool pole = polar - angle <= 0 || polar + angle >= kPi;
    const double spread = pole ? kPi : std::asin(std::min(1.0, std::sin(angle) / std::sin(polar)));
    double turn = (kPi + rotation_ - std::atan2(axis.x, axis.z) - spread) / kTwoPi;
    turn -= std::floor(turn);
    const auto first = static_cast<std::size_t>(turn * static_cast<double>(width_));
    const std::size_t columns =
        std::min(width_, static_cast<std::size_t>(spread / kPi * static_cast<double>(width_)) + 2);
    float highest = 0;
    for (std::size_t y = row(polar - angle); y <= row(polar + angle); ++y)
        for (std::size_t x = 0; x < columns; ++x)
            highest =
                std::max(highest, luminance(map_[y * width_ + (first + x) % width_].radiance));
    return highest;
}

}  // namespace shadowcache
