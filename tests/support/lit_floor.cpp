#include "tests/support/lit_floor.h"

#include <algorithm>

#include "common/random/sequence.h"

namespace shadowcache::test {

namespace {

const Rgb kSky(1, 0.5f, 2);
constexpr float kLampRadiance = 40;  ///< in units of the sky's
const Vec3d kSeenLamp(-1, 0.7, 0.1), kHiddenLamp(1.25, 1, 0);
constexpr double kFloorHeight = 0.6, kFloorWidth = kFloorHeight * View::kWidth / View::kHeight;

std::array<int, 2> texelOf(const Vec3d& direction) {
    return texelAt(Light::kMapWidth, Light::kMapHeight, direction.normalized());
}

/// The base cell of `direction` is called `n` of 200 by every item; the rest stays as baked.
void setOneCell(BakeResult& baked, const Vec3d& direction, int n) {
    const DirectionTiers tiers = baked.header.tiers();
    const std::uint32_t cell = locateCell(tiers.baseLevel(), direction.normalized());
    const CacheItems correct = baked.items;
    baked.items.blocks.clear();
    baked.items.firstBlock = {0};
    for (std::size_t i = 0; i < correct.size(); ++i) {
        baked.items.n[i * tiers.baseCells() + cell] = static_cast<std::uint8_t>(n);
        baked.items.d[i * tiers.baseCells() + cell] = 200;
        for (std::uint32_t b = correct.firstBlock[i]; b < correct.firstBlock[i + 1]; ++b) {
            const std::uint32_t key = correct.blocks[b].key;
            const bool first = key < tiers.blockKey(1, 0);
            const std::uint32_t parent = first ? key : (key - tiers.blockKey(1, 0)) / kBlockCells;
            if (parent != cell) baked.items.blocks.push_back(correct.blocks[b]);
        }
        baked.items.firstBlock.push_back(static_cast<std::uint32_t>(baked.items.blocks.size()));
    }
}

}  // namespace

void fillCounts(BakeResult& baked, const std::function<std::array<int, 2>(std::size_t)>& counts) {
    for (std::size_t i = 0; i < baked.items.n.size(); ++i) {
        const auto [n, d] = counts(i);
        baked.items.n[i] = static_cast<std::uint8_t>(n);
        baked.items.d[i] = static_cast<std::uint8_t>(d);
    }
    baked.items.blocks.clear();
    std::ranges::fill(baked.items.firstBlock, 0u);
}

Light::Light()
    : seen(texelOf(kSeenLamp)), hidden(texelOf(kHiddenLamp)), map{kMapWidth, kMapHeight, {}} {
    map.pixels.assign(static_cast<std::size_t>(kMapWidth * kMapHeight), kSky);
    for (const auto& [x, y] : {seen, hidden})
        map.pixels[static_cast<std::size_t>(y * kMapWidth + x)] = kSky * kLampRadiance;
}

Camera View::camera() {
    return {{0, 0.25, 0}, {0, -1, 0}, {0, 0, -1}, 1, kFloorHeight};
}

ShadingPoint View::place(double filmX, double filmY) {
    const Vec3d p((filmX - 0.5) * kFloorWidth, 0, (filmY - 0.5) * kFloorHeight);
    return {{Vec3f(p), p, {0, 1, 0}, {0, 1, 0}}, {}};
}

std::vector<CacheKind> cacheKinds() {
    return {{"Correct", [](BakeResult&) {}},
            {"AllDark",
             [](BakeResult& b) { fillCounts(b, [](std::size_t) {
                                     return std::array{0, 255};
                                 }); }},
            {"AllVisible",
             [](BakeResult& b) {
                 fillCounts(b, [](std::size_t) { return std::array{255, 255}; });
             }},
            {"Random",
             [](BakeResult& b) {
                 fillCounts(b, [](std::size_t i) {
                     const std::uint64_t h = hashWords(91, i);
                     const int d = static_cast<int>(h % 256);
                     return std::array{
                         static_cast<int>((h >> 20) % static_cast<std::uint64_t>(d + 1)), d};
                 });
             }},
            {"LampOccluded", [](BakeResult& b) { setOneCell(b, kSeenLamp, 0); }},
            {"LampVisible", [](BakeResult& b) { setOneCell(b, kHiddenLamp, 200); }}};
}

RenderOptions effort(int cameraRays, int samples) {
    RenderOptions options;
    options.width = View::kWidth;
    options.height = View::kHeight;
    options.cameraRays = cameraRays;
    options.samples = samples;
    return options;
}

double LitFloor::at(double filmX, double filmY) const {
    const double lamp =
        (static_cast<double>(kLampRadiance) - 1) *
        texelMoment(Light::kMapWidth, Light::kMapHeight, light.seen[0], light.seen[1]).y;
    return kPi + lamp - hiddenByConvex(mesh, 2, mesh.triangles.size(), View::place(filmX, filmY));
}

Rgb LitFloor::pixelTruth(int x, int y) const {
    return kSky * static_cast<float>(at((x + 0.5) / View::kWidth, (y + 0.5) / View::kHeight));
}

Rgb LitFloor::truth(int strip, int nodes) const {
    double sum = 0;
    const int columns = View::kWidth / kStrips * nodes, rows = View::kHeight * nodes;
    for (int i = 0; i < columns; ++i)
        for (int j = 0; j < rows; ++j)
            sum += at((strip + (i + 0.5) / columns) / kStrips, (j + 0.5) / rows);
    return kSky * static_cast<float>(sum / (columns * rows));
}

BakeResult LitFloor::baked(const CacheKind& kind) const {
    BakeOptions options;
    options.spacing = 0.5;
    BakeResult result = bake(scene, options);
    kind.change(result);
    return result;
}

}  // namespace shadowcache::test
