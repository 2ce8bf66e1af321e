#include "render/estimators/light_tiles.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <queue>

namespace shadowcache {

namespace {

/// Cosine that stands for a tile whose light is below the horizon but which is above it in part.
constexpr float kLeastCosine = 0.01f;

struct Brightness {
    double light;
    LightTiles::Tile tile;
    bool operator<(const Brightness& other) const { return light < other.light; }
};

/// First cell of Environment::kLevel in a tile.
std::uint32_t firstFineCell(const LightTiles::Tile& tile) {
    return tile.cell << (2 * (Environment::kLevel - tile.level));
}

std::vector<LightTiles::Tile> split(const Environment& environment, std::size_t count) {
    std::priority_queue<Brightness> open;
    std::vector<LightTiles::Tile> tiles;
    const auto push = [&](int level, std::uint32_t cell) {
        const double light = environment.luminanceIntegral(level, cell);
        if (!(light > 0)) return;
        if (level == Environment::kLevel)
            tiles.push_back({level, cell});
        else
            open.push({light, {level, cell}});
    };
    for (std::uint32_t cell = 0; cell < cellCount(0); ++cell) push(0, cell);
    while (!open.empty() && open.size() + tiles.size() + 3 <= count) {
        const LightTiles::Tile parent = open.top().tile;
        open.pop();
        for (std::uint32_t child = 0; child < 4; ++child)
            push(parent.level + 1, 4 * parent.cell + child);
    }
    for (; !open.empty(); open.pop()) tiles.push_back(open.top().tile);
    std::sort(tiles.begin(), tiles.end(),
              [](const auto& a, const auto& b) { return firstFineCell(a) < firstFineCell(b); });
    return tiles;
}

}  // namespace

LightTiles::LightTiles(const Environment& environment, std::size_t count)
    : tiles_(split(environment, count)), tileOfCell_(cellCount(Environment::kLevel), 0) {
    assert(count >= cellCount(0) && count <= kMost);
    for (std::size_t i = 0; i < tiles_.size(); ++i) {
        addTile(environment, tiles_[i]);
        const std::uint32_t first = firstFineCell(tiles_[i]);
        const std::uint32_t cells = 1u << (2 * (Environment::kLevel - tiles_[i].level));
        std::fill_n(tileOfCell_.begin() + first, cells, static_cast<std::uint8_t>(i));
    }
}

void LightTiles::addTile(const Environment& environment, const Tile& tile) {
    const CellMoments& cells = environment.cells(tile.level, tile.cell / CellMoments::kSize);
    const std::size_t k = tile.cell % CellMoments::kSize;
    const auto light = static_cast<float>(environment.luminanceIntegral(tile.level, tile.cell));
    light_.push_back(light);
    float square = 0;
    for (std::size_t j = 0; j < 3; ++j) {
        const float moment = environment.luminance(Rgb(
            cells.firstMoment[0][j][k], cells.firstMoment[1][j][k], cells.firstMoment[2][j][k]));
        mean_[j].push_back(moment / light);
        square += mean_[j].back() * mean_[j].back();
        axis_[j].push_back(cells.axis[j][k]);
    }
    // The light's variance is 1 - |mean|^2. As that of a disc of radius r at right angles it is
    // r^2 / 2, and n . w over the disc varies as over an interval of half width r sqrt(3/4).
    reach_.push_back(std::sqrt(1.5f * std::max(1e-6f, 1 - square)));
    sinRadius_.push_back(cells.sinRadius[k]);
}

void LightTiles::cosines(const Vec3f& n, std::span<float> out) const noexcept {
    for (std::size_t i = 0; i < size(); ++i) {
        // Mean of max(0, x) over x in [h - reach, h + reach].
        const float h = n.x * mean_[0][i] + n.y * mean_[1][i] + n.z * mean_[2][i];
        const float reach = reach_[i];
        const float part = std::min(std::max(h + reach, 0.0f), 2 * reach);
        const float cosine = part * part / (4 * reach) + std::max(0.0f, h - reach);
        const float top = n.x * axis_[0][i] + n.y * axis_[1][i] + n.z * axis_[2][i] + sinRadius_[i];
        out[i] = std::max(cosine, kLeastCosine * std::min(std::max(top, 0.0f), 1.0f));
    }
}

}  // namespace shadowcache
