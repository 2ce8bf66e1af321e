#include "common/math/cell_finder.h"

#include "common/base/parallel.h"

namespace shadowcache {

namespace {

constexpr std::size_t kCellsPerChunk = 1024;

Vec3d cornerOf(const SphericalTriangle& t, std::uint32_t corner) {
    return corner == 0 ? t.a : corner == 1 ? t.b : t.c;
}

/// The face of the icosahedron beyond a side of another, and its side, as CellFinder has them.
std::uint32_t neighborOfFace(std::uint32_t face, std::uint32_t side) {
    const SphericalTriangle t = cellTriangle(0, face);
    for (std::uint32_t f = 0; f < cellCount(0); ++f)
        for (std::uint32_t s = 0; s < 3; ++s) {
            const SphericalTriangle other = cellTriangle(0, f);
            if (cornerOf(other, s) == cornerOf(t, (side + 1) % 3) &&
                cornerOf(other, (s + 1) % 3) == cornerOf(t, side))
                return 4 * f + s;
        }
    return 0;  // never
}

}  // namespace

CellFinder::CellFinder(int level) : level_(level), cells_(cellCount(0)) {
    for (std::uint32_t face = 0; face < cells_.size(); ++face)
        for (std::uint32_t side = 0; side < 3; ++side)
            cells_[face].neighbor[side] = neighborOfFace(face, side);
    for (int l = 1; l <= level; ++l) {
        std::vector<Cell> children(cellCount(l));
        addNeighbors(children);
        cells_.swap(children);
    }
    parallelFor(cells_.size(), kCellsPerChunk, [&](const Chunk& chunk) {
        for (std::size_t c = chunk.begin; c < chunk.end; ++c) {
            const SphericalTriangle t = cellTriangle(level_, static_cast<std::uint32_t>(c));
            cells_[c].plane = {Vec3f(t.a.cross(t.b)), Vec3f(t.b.cross(t.c)), Vec3f(t.c.cross(t.a))};
        }
    });
}

/// Child i < 3 stands at corner i: its sides i and i + 2 are halves of the parent's, and the one
/// between them borders the middle child, 3, whose side i borders child i + 1.
void CellFinder::addNeighbors(std::vector<Cell>& children) const {
    for (std::uint32_t parent = 0; parent < cells_.size(); ++parent)
        for (std::uint32_t i = 0; i < 3; ++i) {
            const std::uint32_t before = (i + 2) % 3, inner = (i + 1) % 3;
            Cell& child = children[4 * parent + i];
            child.neighbor[inner] = 4 * (4 * parent + 3) + before;
            children[4 * parent + 3].neighbor[before] = 4 * (4 * parent + i) + inner;
            for (const std::uint32_t side : {i, before}) {
                // The neighbour has the side's corners the other way round.
                const std::uint32_t other = cells_[parent].neighbor[side] / 4;
                const std::uint32_t otherSide = cells_[parent].neighbor[side] % 4;
                const std::uint32_t corner = side == i ? (otherSide + 1) % 3 : otherSide;
                child.neighbor[side] = 4 * (4 * other + corner) + otherSide;
            }
        }
}

}  // namespace shadowcache
