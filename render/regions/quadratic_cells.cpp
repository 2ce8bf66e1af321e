#include "render/regions/quadratic_cells.h"

#include "common/base/parallel.h"

namespace shadowcache {

namespace {

constexpr std::size_t kBlocksPerChunk = 16;

/// Corners of the sides, in the order of the products.
constexpr int kSides[3][2] = {{0, 1}, {1, 2}, {2, 0}};
/// Share of the nearest corner and of the others, at the places where fits are judged.
constexpr double kNear = 4;

void set(const Vec3d& v, int i, float (&to)[3][kBlockCells]) {
    for (int k = 0; k < 3; ++k) to[k][i] = static_cast<float>(v[k]);
}

/// Rows of the matrix that takes a direction to (l0, l1, l2).
template <class T>
std::array<Imath::Vec3<T>, 3> dualBasis(const Imath::Vec3<T> (&corner)[3]) {
    const Imath::Vec3<T> across = corner[1].cross(corner[2]);
    const T scale = 1 / across.dot(corner[0]);
    return {across * scale, corner[2].cross(corner[0]) * scale, corner[0].cross(corner[1]) * scale};
}

void setCell(const CellMoments& m, int level, std::uint32_t cell, QuadraticBlock& block) {
    const auto i = static_cast<int>(cell % kBlockCells);
    const SphericalTriangle t = cellTriangle(level, cell);
    const Vec3d corner[3] = {t.a, t.b, t.c};
    for (int k = 0; k < 3; ++k) {
        const auto [p, q] = kSides[k];
        const Vec3d middle = corner[p] + corner[q];
        const Vec3d near = corner[0] + corner[1] + corner[2] + corner[k] * (kNear - 1);
        set(corner[k], i, block.place[k]);
        set(middle.normalized(), i, block.place[3 + k]);
        set(near.normalized(), i, block.place[6 + k]);
        block.side[k][i] = static_cast<float>(middle.length2());
        block.within[k][i] = static_cast<float>(1 / near.length2());
    }
    const std::array<Vec3d, 3> row = dualBasis(corner);
    for (int color = 0; color < 3; ++color) {
        const auto& second = m.second[color];
        const auto s = [&](int k) { return static_cast<double>(second[k][i]); };
        const auto times = [&](const Vec3d& v) {
            return Vec3d(s(0) * v.x + s(3) * v.y + s(4) * v.z, s(3) * v.x + s(1) * v.y + s(5) * v.z,
                         s(4) * v.x + s(5) * v.y + s(2) * v.z);
        };
        for (int k = 0; k < 3; ++k) {
            const Vec3d at = times(row[static_cast<std::size_t>(k)]);
            const auto next = static_cast<std::size_t>(kSides[k][1]);
            block.moment[color][k][i] =
                static_cast<float>(row[static_cast<std::size_t>(k)].dot(at));
            block.moment[color][3 + k][i] = static_cast<float>(row[next].dot(at));
        }
    }
}

}  // namespace

QuadraticCells::QuadraticCells(const Environment& environment, const DirectionTiers& tiers)
    : finest_(Environment::kLevel - (tiers.baseLevel() == Environment::kLevel % 2 ? 0 : 1)) {
    for (int level = tiers.baseLevel(); level <= finest_; level += 2) {
        std::vector<QuadraticBlock>& blocks = blocks_[static_cast<std::size_t>(level)];
        blocks.resize((cellCount(level) + kBlockCells - 1) / kBlockCells);
        parallelFor(blocks.size(), kBlocksPerChunk, [&](const Chunk& chunk) {
            for (std::size_t b = chunk.begin; b < chunk.end; ++b) {
                const auto block = static_cast<std::uint32_t>(b);
                for (std::uint32_t i = 0; i < kBlockCells; ++i) {
                    // Past the last cell a copy of it, without light.
                    const std::uint32_t cell = block * kBlockCells + i;
                    const std::uint32_t last = cellCount(level) - 1;
                    if (cell <= last)
                        setCell(environment.cells(level, block), level, cell, blocks[b]);
                    else
                        for (auto& place : blocks[b].place)
                            set(Vec3d(0, 1, 0), static_cast<int>(i), place);
                }
            }
        });
    }
}

Rgb QuadraticCells::value(const QuadraticFit& fit, int level, std::uint32_t cell,
                          const Vec3f& w) const {
    const QuadraticBlock& cells = block(level, cell / kBlockCells);
    const std::size_t i = cell % kBlockCells;
    Vec3f corner[3];
    for (int k = 0; k < 3; ++k)
        corner[k] = Vec3f(cells.place[k][0][i], cells.place[k][1][i], cells.place[k][2][i]);
    const std::array<Vec3f, 3> row = dualBasis(corner);
    const float l[3] = {row[0].dot(w), row[1].dot(w), row[2].dot(w)};
    Rgb sum;
    for (int color = 0; color < 3; ++color) {
        const auto& product = fit.product[color];
        sum[color] = product[0][i] * l[0] * l[0] + product[1][i] * l[1] * l[1] +
                     product[2][i] * l[2] * l[2] + product[3][i] * l[0] * l[1] +
                     product[4][i] * l[1] * l[2] + product[5][i] * l[2] * l[0];
    }
    return sum;
}

void fitQuadratic(const QuadraticBlock& cells, const PlaceValues& values, QuadraticFit& fit) {
    for (int color = 0; color < 3; ++color)
        for (int k = 0; k < 3; ++k) {
            const float* from = values[kSides[k][0]][color];
            const float* to = values[kSides[k][1]][color];
            const float* middle = values[3 + k][color];
            for (int i = 0; i < kBlockCells; ++i) {
                fit.product[color][k][i] = from[i];
                fit.product[color][3 + k][i] = cells.side[k][i] * middle[i] - from[i] - to[i];
            }
        }
}

void setConstant(const QuadraticBlock& cells, int cell, const Rgb& value, QuadraticFit& fit) {
    for (int color = 0; color < 3; ++color)
        for (int k = 0; k < 3; ++k) {
            fit.product[color][k][cell] = value[color];
            fit.product[color][3 + k][cell] = value[color] * (cells.side[k][cell] - 2);
        }
}

void fitWithin(const QuadraticBlock& cells, const QuadraticFit& fit, int number, int color,
               float (&values)[kBlockCells]) {
    const auto near = static_cast<float>(kNear);
    const auto& product = fit.product[color];
    const int next = kSides[number][1], last = 3 - number - next;
    const float *a = product[number], *b = product[next], *c = product[last];
    // Sides that meet at the nearest corner, and the one opposite.
    const float *ab = product[3 + number], *ca = product[3 + last], *bc = product[3 + next];
    for (int i = 0; i < kBlockCells; ++i)
        values[i] = cells.within[number][i] *
                    (near * near * a[i] + b[i] + c[i] + near * (ab[i] + ca[i]) + bc[i]);
}

void integrateQuadratic(const QuadraticBlock& cells, const QuadraticFit& fit,
                        float (&integral)[3][kBlockCells]) {
    for (int color = 0; color < 3; ++color) {
        const auto& product = fit.product[color];
        const auto& moment = cells.moment[color];
        for (int i = 0; i < kBlockCells; ++i) {
            float sum = 0;
            for (int k = 0; k < 6; ++k) sum += product[k][i] * moment[k][i];
            integral[color][i] = sum;
        }
    }
}

}  // namespace shadowcache
