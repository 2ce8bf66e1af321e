#include "common/light/environment_map.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "common/base/error.h"
#include "common/base/interrupt.h"
#include "common/base/parallel.h"
#include "common/base/progress.h"
#include "common/light/light_steps.h"
#include "common/math/cell_finder.h"

namespace shadowcache {

namespace {

/// Smaller maps are replicated to this size, so that cells hold whole texels and a step in
/// longitude is small enough for the series in placeIn().
constexpr std::size_t kMinWidth = 1024;
constexpr std::size_t kMinHeight = 512;
/// Level of the direction mesh, in the map's frame, whose cells are its grains: two finer than the
/// cells that a turned map's grains are sorted into, so that few of them stand on a cell's border.
/// The next finer one would take four times the time of a turn.
constexpr int kGrainLevel = 7;
constexpr double kTwoPi = 2 * kPi;
constexpr std::size_t kPasses = 4;
constexpr std::size_t kRowsPerChunk = 8;
constexpr std::size_t kSumChunk = 1024;

double share(std::size_t part, std::size_t count) {
    return static_cast<double>(part) / static_cast<double>(count);
}

/// Factors of the integrals over texels: those of a row, by polar angles t0 to t1, times those of a
/// column, by longitudes p0 to p1.
struct RowFactors {
    double sin2, sinCos, sin3, cos2Sin, sin2Cos, cosines;
};
struct ColumnFactors {
    double width, sine, cosine, sine2, cosine2, mixed;
};

RowFactors rowFactors(double t0, double t1) {
    const auto cube = [](double x) { return x * x * x; };
    const double cosines = std::cos(t0) - std::cos(t1);
    const double cos2Sin = (cube(std::cos(t0)) - cube(std::cos(t1))) / 3;
    return {(t1 - t0) / 2 - (std::sin(2 * t1) - std::sin(2 * t0)) / 4,
            (std::sin(t1) * std::sin(t1) - std::sin(t0) * std::sin(t0)) / 2,
            cosines - cos2Sin,
            cos2Sin,
            (cube(std::sin(t1)) - cube(std::sin(t0))) / 3,
            cosines};
}

ColumnFactors columnFactors(double p0, double p1) {
    const double width = p1 - p0;
    const double wobble = (std::sin(2 * p1) - std::sin(2 * p0)) / 4;
    return {width,
            std::cos(p0) - std::cos(p1),
            std::sin(p1) - std::sin(p0),
            width / 2 - wobble,
            width / 2 + wobble,
            (std::sin(p1) * std::sin(p1) - std::sin(p0) * std::sin(p0)) / 2};
}

/// What the texels of a row, and those of a column, have in common.
struct MapFactors {
    std::vector<RowFactors> rows;
    std::vector<ColumnFactors> columns;
    std::vector<std::array<float, 2>> rowCenters, columnCenters;  ///< cosine and sine
    float texelRadius;                                            ///< [rad] of any texel, at most

    MapFactors(std::size_t width, std::size_t height)
        : texelRadius(static_cast<float>(
              0.5 * kPi * std::hypot(share(1, height), 2 * share(1, width)) + 1e-6)) {
        const auto cosineAndSine = [](double angle) {
            return std::array{static_cast<float>(std::cos(angle)),
                              static_cast<float>(std::sin(angle))};
        };
        for (std::size_t y = 0; y < height; ++y) {
            rows.push_back(rowFactors(kPi * share(y, height), kPi * share(y + 1, height)));
            rowCenters.push_back(cosineAndSine(kPi * share(2 * y + 1, 2 * height)));
        }
        for (std::size_t x = 0; x < width; ++x) {
            columns.push_back(
                columnFactors(kPi - kTwoPi * share(x + 1, width), kPi - kTwoPi * share(x, width)));
            columnCenters.push_back(cosineAndSine(kPi - kTwoPi * share(2 * x + 1, 2 * width)));
        }
    }

    Vec3f center(std::size_t y, std::size_t x) const {
        return {rowCenters[y][1] * columnCenters[x][1], rowCenters[y][0],
                rowCenters[y][1] * columnCenters[x][0]};
    }
};

/// As EnvironmentMap::Integrals, of a texel of radiance 1 in one colour.
using TexelIntegrals = std::array<double, EnvironmentMap::Integrals::kOfColor>;

TexelIntegrals integrateTexel(const RowFactors& r, const ColumnFactors& c) {
    return {r.sin3 * c.sine2,   r.cos2Sin * c.width, r.sin3 * c.cosine2,
            r.sin2Cos * c.sine, r.sin3 * c.mixed,    r.sin2Cos * c.cosine,
            r.sin2 * c.sine,    r.sinCos * c.width,  r.sin2 * c.cosine};
}

}  // namespace

EnvironmentMap::EnvironmentMap(const Image& map, const Rgb& luminanceWeights)
    : luminanceWeights_(luminanceWeights) {
    if (map.width < 1 || map.height < 1) throw Error("environment map: it has no texels");
    chooseSize(map);
    Progress progress("map tables", kPasses * width_ * height_);
    copyTexels(map, progress);
    rowCos_.resize(height_ + 1);
    for (std::size_t y = 0; y <= height_; ++y)
        rowCos_[y] = static_cast<float>(std::cos(kPi * share(y, height_)));
    columnCos_.resize(width_);
    columnSin_.resize(width_);
    for (std::size_t x = 0; x < width_; ++x) {
        const double longitude = kPi - kTwoPi * share(x, width_);
        columnCos_[x] = static_cast<float>(std::cos(longitude));
        columnSin_[x] = static_cast<float>(std::sin(longitude));
    }
    nameGrains(progress);
    sortTexels(progress);
    integrate(progress);
}

void EnvironmentMap::chooseSize(const Image& map) {
    const auto repeated = [](int side, std::size_t least) {
        const auto texels = static_cast<std::size_t>(side);
        return texels * ((least + texels - 1) / texels);
    };
    width_ = repeated(map.width, kMinWidth);
    height_ = repeated(map.height, kMinHeight);
    if (width_ * height_ > std::size_t{1} << 31)
        throw Error(fmt::format("environment map: {}x{} texels, at most 2^31 are supported",
                                map.width, map.height));
}

void EnvironmentMap::copyTexels(const Image& map, Progress& progress) {
    const auto mapWidth = static_cast<std::size_t>(map.width);
    const std::size_t repeatX = width_ / mapWidth;
    const std::size_t repeatY = height_ / static_cast<std::size_t>(map.height);
    map_.resize(width_ * height_);
    parallelFor(height_, kRowsPerChunk, [&](const Chunk& rows) {
        throwIfInterrupted();
        for (std::size_t y = rows.begin; y < rows.end; ++y)
            for (std::size_t x = 0; x < width_; ++x)
                map_[y * width_ + x] = {map.pixels[(y / repeatY) * mapWidth + x / repeatX], 0};
        progress.add((rows.end - rows.begin) * width_);
    });
}

void EnvironmentMap::nameGrains(Progress& progress) {
    const CellFinder finder(kGrainLevel);
    const MapFactors factors(width_, height_);
    grainOf_.resize(map_.size());
    parallelFor(height_, kRowsPerChunk, [&](const Chunk& rows) {
        throwIfInterrupted();
        std::uint32_t cell = 0;
        for (std::size_t y = rows.begin; y < rows.end; ++y)
            for (std::size_t x = 0; x < width_; ++x) {
                cell = finder.find(factors.center(y, x), cell);
                grainOf_[y * width_ + x] = cell;
            }
        progress.add((rows.end - rows.begin) * width_);
    });
}

void EnvironmentMap::sortTexels(Progress& progress) {
    std::vector<std::uint32_t> count(cellCount(kGrainLevel), 0);
    for (const std::uint32_t cell : grainOf_) ++count[cell];
    throwIfInterrupted();
    firstTexel_.assign(1, 0);
    std::vector<std::uint32_t> grain(count.size(), 0);
    for (std::size_t c = 0; c < count.size(); ++c) {
        if (count[c] == 0) continue;
        grain[c] = static_cast<std::uint32_t>(firstTexel_.size() - 1);
        firstTexel_.push_back(firstTexel_.back() + count[c]);
    }
    texels_.resize(map_.size());
    std::vector<std::uint32_t> next(firstTexel_.begin(), firstTexel_.end() - 1);
    for (std::size_t y = 0; y < height_; ++y) {
        throwIfInterrupted();
        for (std::size_t i = y * width_; i < (y + 1) * width_; ++i) {
            grainOf_[i] = grain[grainOf_[i]];
            texels_[next[grainOf_[i]]++] = static_cast<std::uint32_t>(i);
        }
        progress.add(width_);
    }
}

/// Integrates one grain after the other.
class EnvironmentMap::GrainSum {
public:
    GrainSum(EnvironmentMap& map, const MapFactors& factors) : map_(map), factors_(factors) {}

    void integrate(std::size_t grain) {
        const std::uint32_t first = map_.firstTexel_[grain], end = map_.firstTexel_[grain + 1];
        light_.resize(end - first);
        directions_.resize(end - first);
        double sums[std::size(Integrals{}.value)] = {}, total = 0;
        Vec3f middle(0, 0, 0);
        for (std::uint32_t i = first; i < end; ++i) {
            const auto width = static_cast<std::uint32_t>(map_.width_);
            const std::uint32_t index = map_.texels_[i], y = index / width, x = index - y * width;
            const TexelIntegrals one = integrateTexel(factors_.rows[y], factors_.columns[x]);
            const Rgb& radiance = map_.map_[index].radiance;
            for (std::size_t k = 0; k < 3; ++k)
                for (std::size_t j = 0; j < one.size(); ++j)
                    sums[k * one.size() + j] +=
                        one[j] * static_cast<double>(radiance[static_cast<int>(k)]);
            const double light = static_cast<double>(map_.luminanceWeights_.dot(radiance)) *
                                 factors_.rows[y].cosines * factors_.columns[x].width;
            total += light;
            light_[i - first] = light;
            directions_[i - first] = factors_.center(y, x);
            middle += directions_[i - first];
        }
        std::copy(std::begin(sums), std::end(sums), map_.integrals_[grain].value);
        encircle(middle.normalized(), map_.grains_[grain]);
        divideSteps(light_, total, &map_.texelBegin_[first]);
        for (std::uint32_t i = first; i < end; ++i)
            if (light_[i - first] > 0) setDensity(i, end);
    }

private:
    void encircle(const Vec3f& center, Grain& grain) const {
        float square = 0;
        for (const Vec3f& w : directions_) square = std::max(square, (w - center).length2());
        grain = {center, 2 * std::asin(std::sqrt(square) / 2) + factors_.texelRadius};
    }

    void setDensity(std::uint32_t place, std::uint32_t end) {
        const std::uint32_t index = map_.texels_[place];
        map_.map_[index].density =
            static_cast<float>(stepsOf(map_.texelBegin_.data(), place, end) / kSteps) /
            map_.solidAngleOf(index);
    }

    EnvironmentMap& map_;
    const MapFactors& factors_;
    std::vector<double> light_;
    std::vector<Vec3f> directions_;
};

void EnvironmentMap::integrate(Progress& progress) {
    const MapFactors factors(width_, height_);
    const std::size_t count = firstTexel_.size() - 1;
    grains_.resize(count);
    integrals_.resize(count);
    texelBegin_.resize(texels_.size());
    parallelFor(count, kSumChunk, [&](const Chunk& chunk) {
        throwIfInterrupted();
        GrainSum sum(*this, factors);
        for (std::size_t g = chunk.begin; g < chunk.end; ++g) sum.integrate(g);
        progress.add(firstTexel_[chunk.end] - firstTexel_[chunk.begin]);
    });
}

std::uint32_t EnvironmentMap::texelAlong(const Vec3f& direction) const noexcept {
    float turn = (static_cast<float>(kPi) - std::atan2(direction.x, direction.z)) *
                 static_cast<float>(1 / kTwoPi);
    turn -= std::floor(turn);
    const float polar =
        std::acos(std::clamp(direction.y, -1.0f, 1.0f)) * static_cast<float>(1 / kPi);
    const auto x = static_cast<std::size_t>(turn * static_cast<float>(width_));
    const auto y = static_cast<std::size_t>(polar * static_cast<float>(height_));
    return static_cast<std::uint32_t>(std::min(y, height_ - 1) * width_ + std::min(x, width_ - 1));
}

std::uint32_t EnvironmentMap::texelAtStep(std::uint32_t grain, std::uint32_t step) const noexcept {
    const auto [first, end] = texelsOf(grain);
    return texels_[first + lastAtMost(&texelBegin_[first], end - first, step)];
}

Vec3d EnvironmentMap::centerOf(std::uint32_t index) const noexcept {
    const double polar = kPi * share(2 * (index / width_) + 1, 2 * height_);
    const double longitude = kPi - kTwoPi * share(2 * (index % width_) + 1, 2 * width_);
    return {std::sin(polar) * std::sin(longitude), std::cos(polar),
            std::sin(polar) * std::cos(longitude)};
}

float EnvironmentMap::solidAngleOf(std::uint32_t index) const noexcept {
    const std::size_t y = index / width_;
    return static_cast<float>(kTwoPi / static_cast<double>(width_)) * (rowCos_[y] - rowCos_[y + 1]);
}

Vec3d EnvironmentMap::placeIn(std::uint32_t index, double x, double y) const noexcept {
    const std::size_t row = index / width_, column = index % width_;
    const auto top = static_cast<double>(rowCos_[row]),
               bottom = static_cast<double>(rowCos_[row + 1]);
    const double cosPolar = top + (bottom - top) * y;
    const double sinPolar = std::sqrt(std::max(0.0, 1 - cosPolar * cosPolar));
    const double longitude =
        kPi - kTwoPi * (static_cast<double>(column) + x) / static_cast<double>(width_);
    return {sinPolar * std::sin(longitude), cosPolar, sinPolar * std::cos(longitude)};
}

Vec3f EnvironmentMap::placeIn(std::uint32_t index, float x, float y) const noexcept {
    const std::size_t row = index / width_, column = index % width_;
    const float cosTop = rowCos_[row], cosBottom = rowCos_[row + 1];
    const float cosPolar = cosTop + (cosBottom - cosTop) * y;
    const float sinPolar = std::sqrt(std::max(0.0f, 1 - cosPolar * cosPolar));
    // Turn back from the texel's border by less than 0.007 rad: three terms give 1e-10.
    const float d = static_cast<float>(kTwoPi) / static_cast<float>(width_) * x;
    const float sinD = d * (1 - d * d / 6), cosD = 1 - d * d / 2;
    return {sinPolar * (columnSin_[column] * cosD - columnCos_[column] * sinD), cosPolar,
            sinPolar * (columnCos_[column] * cosD + columnSin_[column] * sinD)};
}

float EnvironmentMap::greatest(const Vec3d& axis, double angle, const Rgb& weights) const noexcept {
    const double polar = std::acos(std::clamp(axis.y, -1.0, 1.0));
    const auto row = [&](double p) {
        const double y = std::clamp(p / kPi, 0.0, 1.0) * static_cast<double>(height_);
        return std::min(static_cast<std::size_t>(y), height_ - 1);
    };
    const bool pole = polar - angle <= 0 || polar + angle >= kPi;
    const double spread = pole ? kPi : std::asin(std::min(1.0, std::sin(angle) / std::sin(polar)));
    double turn = (kPi - std::atan2(axis.x, axis.z) - spread) / kTwoPi;
    turn -= std::floor(turn);
    const auto first = static_cast<std::size_t>(turn * static_cast<double>(width_));
    const std::size_t columns =
        std::min(width_, static_cast<std::size_t>(spread / kPi * static_cast<double>(width_)) + 2);
    float highest = 0;
    for (std::size_t y = row(polar - angle); y <= row(polar + angle); ++y)
        for (std::size_t x = 0; x < columns; ++x)
            highest =
                std::max(highest, weights.dot(map_[y * width_ + (first + x) % width_].radiance));
    return highest;
}

}  // namespace shadowcache
