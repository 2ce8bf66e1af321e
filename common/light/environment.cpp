#include "common/light/environment.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>

#include "common/base/parallel.h"
#include "common/light/light_steps.h"
#include "common/math/cell_finder.h"

namespace shadowcache {

namespace {

using Integrals = EnvironmentMap::Integrals;

constexpr std::size_t kSortChunk = 8192;
/// Grains between the one that is summed and the one whose integrals are fetched.
constexpr std::uint32_t kPrefetch = 16;
/// The cells below one of this level are summed together.
constexpr int kTreeLevel = 1;

const CellFinder& cellFinder() {
    static const CellFinder finder(Environment::kLevel);
    return finder;
}

/// Circles around the cells of all levels.
const std::vector<CellCap>& caps(int level) {
    static const auto all = [] {
        std::array<std::vector<CellCap>, Environment::kLevel + 1> table;
        for (int l = 0; l <= Environment::kLevel; ++l)
            for (std::uint32_t c = 0; c < cellCount(l); ++c)
                table[static_cast<std::size_t>(l)].push_back(cellCap(l, c));
        return table;
    }();
    return all[static_cast<std::size_t>(level)];
}

/// The two factors of xx, yy, zz, xy, xz, yz.
constexpr int kFactors[Integrals::kSecond][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};

}  // namespace

/// What a turn makes of integrals over a cell: M v of a first moment, M S M^T of a second one.
struct Environment::IntegralTurn {
    double first[3][3];
    double second[Integrals::kSecond][Integrals::kSecond];

    explicit IntegralTurn(const Turn& turn) {
        for (int row = 0; row < 3; ++row)
            for (int column = 0; column < 3; ++column)
                first[row][column] = turn.axis[static_cast<std::size_t>(column)][row];
        for (int r = 0; r < Integrals::kSecond; ++r)
            for (int s = 0; s < Integrals::kSecond; ++s) {
                const auto [p, q] = kFactors[r];
                const auto [i, j] = kFactors[s];
                second[r][s] = first[p][i] * first[q][j];
                if (i != j) second[r][s] += first[p][j] * first[q][i];
            }
    }
};

/// What is summed over a cell, in world space.
struct Environment::Sums {
    double second[3][Integrals::kSecond] = {};
    double first[3][3] = {};
    double luminance = 0;
    float reach = 0;   ///< radius of its largest grain [rad]
    float radius = 0;  ///< of the circle around the cell's centroid that holds its grains [rad]

    void add(const Sums& other) {
        for (int k = 0; k < 3; ++k) {
            for (int j = 0; j < Integrals::kSecond; ++j) second[k][j] += other.second[k][j];
            for (int j = 0; j < 3; ++j) first[k][j] += other.first[k][j];
        }
        luminance += other.luminance;
        reach = std::max(reach, other.reach);
    }

    void setTurned(const IntegralTurn& turn, const Rgb& gain, const double* sums) {
        for (int k = 0; k < 3; ++k) {
            const double* from = sums + std::ptrdiff_t{Integrals::kOfColor} * k;
            const auto factor = static_cast<double>(gain[k]);
            for (int r = 0; r < Integrals::kSecond; ++r) {
                double sum = 0;
                for (int s = 0; s < Integrals::kSecond; ++s) sum += turn.second[r][s] * from[s];
                second[k][r] = factor * sum;
            }
            from += Integrals::kSecond;
            for (int r = 0; r < 3; ++r)
                first[k][r] = factor * (turn.first[r][0] * from[0] + turn.first[r][1] * from[1] +
                                        turn.first[r][2] * from[2]);
        }
    }
};

Environment::Environment(std::shared_ptr<const EnvironmentMap> map, const Turn& turn,
                         const Rgb& gain)
    : map_(std::move(map)) {
    this->turn(turn, gain);
}

Environment::Environment(const Image& map, double rotationDegrees, const Rgb& luminanceWeights)
    : Environment(std::make_shared<const EnvironmentMap>(map, luminanceWeights),
                  turnByAngles({0, rotationDegrees, 0})) {}

void Environment::turn(const Turn& turn, const Rgb& gain) {
    turn_ = turn;
    gain_ = gain;
    for (std::size_t k = 0; k < 3; ++k) axis_[k] = Vec3f(turn.axis[k]);
    sortGrains();
    sumCells();
    accumulate();
}

void Environment::sortGrains() {
    const std::span<const EnvironmentMap::Grain> grains = map_->grains();
    const std::size_t count = grains.size();
    placeOf_.resize(count);
    const CellFinder& finder = cellFinder();
    parallelFor(count, kSortChunk, [&](const Chunk& chunk) {
        std::uint32_t cell = 0;
        for (std::size_t g = chunk.begin; g < chunk.end; ++g) {
            cell = finder.find(toWorld(grains[g].center), cell);
            placeOf_[g] = {0, cell};
        }
    });
    firstGrain_.assign(cellCount(kLevel) + 1, 0);
    for (const GrainPlace& place : placeOf_) ++firstGrain_[place.cell + 1];
    for (std::size_t c = 1; c < firstGrain_.size(); ++c) firstGrain_[c] += firstGrain_[c - 1];
    grains_.resize(count);
    grainBegin_.resize(count);
    std::vector<std::uint32_t> next(firstGrain_.begin(), firstGrain_.end() - 1);
    for (std::uint32_t g = 0; g < count; ++g) grains_[next[placeOf_[g].cell]++] = g;
}

void Environment::sumCells() {
    for (int level = 0; level <= kLevel; ++level) {
        const auto l = static_cast<std::size_t>(level);
        luminance_[l].resize(cellCount(level));
        moments_[l].resize((cellCount(level) + CellMoments::kSize - 1) / CellMoments::kSize);
    }
    const IntegralTurn turn(turn_);
    std::vector<Sums> trees(cellCount(kTreeLevel));
    parallelFor(trees.size(), 1, [&](const Chunk& chunk) {
        constexpr std::uint32_t kFinest = 1u << (2 * (kLevel - kTreeLevel));
        std::vector<double> light;
        std::vector<Sums> sums(kFinest);
        const auto tree = static_cast<std::uint32_t>(chunk.begin);
        for (std::uint32_t c = 0; c < kFinest; ++c)
            sumCell(tree * kFinest + c, turn, light, sums[c]);
        for (int level = kLevel; level > kTreeLevel; --level) {
            const std::uint32_t cells = 1u << (2 * (level - kTreeLevel));
            for (std::uint32_t c = 0; c < cells; ++c) tabulate(level, tree * cells + c, sums[c]);
            for (std::uint32_t c = 0; c < cells; ++c) {
                const Sums part = sums[c];
                if (c % 4 == 0) sums[c / 4] = {};
                sums[c / 4].add(part);
            }
        }
        tabulate(kTreeLevel, tree, sums[0]);
        trees[tree] = sums[0];
    });
    sphereLuminance_ = 0;
    for (std::uint32_t c = 0; c < cellCount(0); ++c) {
        Sums sums;
        for (std::uint32_t k = 0; k < 4; ++k) sums.add(trees[4 * c + k]);
        tabulate(0, c, sums);
        sphereLuminance_ += sums.luminance;
    }
}

void Environment::sumCell(std::uint32_t cell, const IntegralTurn& turn, std::vector<double>& light,
                          Sums& sums) {
    const Rgb weights = luminanceWeights() * gain_;
    const Vec3f axis = toMap(Vec3f(caps(kLevel)[cell].axis));
    const std::uint32_t first = firstGrain_[cell], end = firstGrain_[cell + 1];
    light.resize(end - first);
    double total[std::size(Integrals{}.value)] = {};
    sums.luminance = 0;
    sums.reach = sums.radius = 0;
    for (std::uint32_t k = first; k < end; ++k) {
        if (k + kPrefetch < grains_.size()) map_->prefetchIntegrals(grains_[k + kPrefetch]);
        const EnvironmentMap::Grain& grain = map_->grains()[grains_[k]];
        const float distance = (grain.center - axis).length2();
        // The arc above a chord c < 0.1 is at most c + c^3 / 23.
        const float arc = std::sqrt(distance) * (1 + distance / 23);
        sums.reach = std::max(sums.reach, grain.radius);
        sums.radius = std::max(sums.radius, arc + grain.radius);
        const auto& value = map_->integralsOf(grains_[k]).value;
        for (std::size_t j = 0; j < std::size(value); ++j)
            total[j] += static_cast<double>(value[j]);
        // x^2 + y^2 + z^2 = 1.
        double luminance = 0;
        for (int c = 0; c < 3; ++c) {
            const float* of = value + std::ptrdiff_t{Integrals::kOfColor} * c;
            luminance += static_cast<double>(weights[c] * (of[0] + of[1] + of[2]));
        }
        light[k - first] = luminance;
        sums.luminance += luminance;
    }
    sums.setTurned(turn, gain_, total);
    divideSteps(light, sums.luminance, &grainBegin_[first]);
    for (std::uint32_t k = first; k < end; ++k)
        placeOf_[grains_[k]].share =
            light[k - first] > 0 ? static_cast<float>(stepsOf(grainBegin_.data(), k, end) / kSteps)
                                 : 0.0f;
}

void Environment::tabulate(int level, std::uint32_t cell, const Sums& sums) {
    const auto l = static_cast<std::size_t>(level);
    luminance_[l][cell] = sums.luminance;
    CellMoments& m = moments_[l][cell / CellMoments::kSize];
    const std::size_t i = cell % CellMoments::kSize;
    const CellCap& cap = caps(level)[cell];
    for (std::size_t k = 0; k < 3; ++k) {
        m.axis[k][i] = static_cast<float>(cap.axis[static_cast<int>(k)]);
        for (std::size_t j = 0; j < 3; ++j)
            m.firstMoment[k][j][i] = static_cast<float>(sums.first[k][j]);
        for (std::size_t j = 0; j < Integrals::kSecond; ++j)
            m.second[k][j][i] = static_cast<float>(sums.second[k][j]);
    }
    m.sinRadius[i] =
        std::sin(level == kLevel ? sums.radius : static_cast<float>(cap.angle) + sums.reach);
    m.luminanceIntegral[i] = static_cast<float>(sums.luminance);
}

void Environment::accumulate() {
    // Lit cells keep a chance that survives the rounding of the running sum beside a very bright
    // one.
    const std::vector<double>& cells = luminance_[kLevel];
    cellCdf_.assign(cells.size() + 1, 0.0);
    for (std::size_t c = 0; c < cells.size(); ++c)
        cellCdf_[c + 1] = cellCdf_[c] + (cells[c] > 0 ? cells[c] + 1e-13 * sphereLuminance_ : 0.0);
    cellShare_.resize(cells.size());
    for (std::size_t c = 0; c < cells.size(); ++c)
        cellShare_[c] = cells[c] > 0
                            ? static_cast<float>((cellCdf_[c + 1] - cellCdf_[c]) / cellCdf_.back())
                            : 0.0f;
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

Rgb Environment::radiance(const Vec3f& direction) const noexcept {
    return map_->texel(map_->texelAlong(toMap(direction))).radiance * gain_;
}

EnvironmentSample Environment::lookUp(const Vec3f& direction) const noexcept {
    const std::uint32_t index = map_->texelAlong(toMap(direction));
    const EnvironmentMap::Texel& texel = map_->texel(index);
    const GrainPlace& grain = placeOf_[map_->grainOf(index)];
    return {direction, texel.radiance * gain_, texel.density * grain.share * cellShare_[grain.cell],
            grain.cell, index};
}

Environment::Texel Environment::texel(std::size_t i) const noexcept {
    const std::uint32_t index = map_->texelIndex(i);
    return {Vec3f(turn_.apply(map_->centerOf(index))), map_->texel(index).radiance * gain_,
            map_->solidAngleOf(index), index};
}

Vec3d Environment::placeIn(std::size_t i, double x, double y) const noexcept {
    return turn_.apply(map_->placeIn(map_->texelIndex(i), x, y));
}

float Environment::maxLuminance(const Vec3d& axis, double angle) const noexcept {
    return map_->greatest(turn_.undo(axis), angle, luminanceWeights() * gain_);
}

}  // namespace shadowcache
