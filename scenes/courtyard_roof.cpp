#include <cmath>

#include "scenes/courtyard_parts.h"

namespace shadowcache::scenes::courtyard {
namespace {

constexpr double kOverhang = 0.62;
constexpr double kSlope = 0.49;  // radians
constexpr double kTileWidth = 0.25;
constexpr double kTileExposure = 0.41;

/// Barrel tiles over a slope whose width at the distance t up the slope is [low(t), high(t)].
struct Slope {
    Placement at;  ///< x along the eaves, y normal to the slope, z up the slope
    double length;
    double lowEnd, highEnd;        ///< of the eaves
    double lowSpread, highSpread;  ///< growth of either end per metre up the slope
};

void addTile(SetMesh& mesh, const Placement& at, const Rgb& color) {
    addPatch(
        mesh, 4, 1,
        [&](double u, double v) {
            const double angle = kPi * (1 - u);
            const double radius = 0.115 - 0.023 * v;
            return at(radius * std::cos(angle), radius * std::sin(angle) * 0.9 + 0.045 - 0.04 * v,
                      v * (kTileExposure + 0.06));
        },
        plain(color));
}

void addTiles(SetMesh& mesh, const Slope& slope) {
    const double length = slope.length;
    const auto low = [&](double t) { return slope.lowEnd - slope.lowSpread * t; };
    const auto high = [&](double t) { return slope.highEnd + slope.highSpread * t; };
    addQuad(mesh,
            {slope.at(low(0), 0, 0), slope.at(low(length), 0, length),
             slope.at(high(length), 0, length), slope.at(high(0), 0, 0)},
            plain(tinted(kTerracotta, 0.3, 0.05)));
    const int rows = static_cast<int>(std::ceil(length / kTileExposure));
    const double left = std::min(low(0), low(length));
    const double right = std::max(high(0), high(length));
    const int columns = static_cast<int>((right - left) / kTileWidth);
    for (int row = 0; row < rows; ++row) {
        const double t = row * kTileExposure;
        for (int column = 0; column < columns; ++column) {
            const double x = left + (column + 0.5) * (right - left) / columns;
            if (x < low(t) || x > high(t)) continue;
            const auto key = (row * 4096 + column);
            const auto place =
                (std::lround(std::abs(slope.at.origin.x * 7 + slope.at.origin.z * 3 + 900)));
            const double u = noise(key, 1, place);
            const Rgb base = u < 0.12  ? Rgb(0.52f, 0.30f, 0.17f)
                             : u < 0.2 ? Rgb(0.27f, 0.13f, 0.085f)
                                       : kTerracotta;
            addTile(mesh,
                    moved(slope.at, x + 0.012 * (noise(key, 2, place) - 0.5),
                          0.012 * noise(key, 3, place), t - 0.03 - 0.02 * noise(key, 4, place),
                          0.05 * (noise(key, 5, place) - 0.5)),
                    tinted(base, 0.22, noise(key, 6, place)));
        }
    }
}

/// Frame of a slope that starts at the height y and the depth z of `at` and climbs toward +z.
Placement slopeFrame(const Placement& at, double y, double z, double angle) {
    const Vec3d along = at.z * std::cos(angle) + at.y * std::sin(angle);
    return {at(0, y, z), at.x, along.cross(at.x), along};
}

}  // namespace

void addRoof(SetMesh& mesh, const Side& side) {
    const double end = side.half();
    const Imath::V2d cornice[] = {{0.16, -0.03}, {0.21, -0.03}, {0.21, 0.03}, {0.25, 0.06},
                                  {0.27, 0.12},  {0.35, 0.15},  {0.35, 0.24}, {0.10, 0.24}};
    // Toward the east terrace a roof ends in a gable, elsewhere in a valley.
    const bool lowGable = side.facing == Facing::north;
    const bool highGable = side.facing == Facing::south;
    const double low = lowGable ? -end - kShell : -end;
    const double high = highGable ? end + kShell : end;
    std::vector<PathPoint> path;
    for (int i = 0; i <= 8; ++i) {
        Vec3d outward = -side.at.z;
        if (i == 0 && !lowGable) outward += side.at.x;
        if (i == 8 && !highGable) outward -= side.at.x;
        path.push_back({side.at(low + (high - low) * i / 8, kUpperTop, 0), outward, side.at.y});
    }
    addMoulding(mesh, path, cornice, weathered(kStone, 0.12, 0.9));

    const Placement slope = slopeFrame(side.at, kEaves, -kOverhang, kSlope);
    const double spread = std::cos(kSlope);
    const double length = (kShell + kOverhang) / spread;
    const double lowEaves = lowGable ? low - 0.15 : low + kOverhang;
    const double highEaves = highGable ? high + 0.15 : high - kOverhang;
    const double lowSpread = lowGable ? 0 : spread;
    const double highSpread = highGable ? 0 : spread;
    addTiles(mesh, {slope, length, lowEaves, highEaves, lowSpread, highSpread});

    const int rafters = side.bays * 6;  // their ends show under the eaves
    for (int i = 0; i < rafters; ++i) {
        const double x = low + 0.4 + (high - low - 0.8) * i / (rafters - 1);
        addBox(mesh, moved(slope, x, 0, 0), {-0.05, -0.15, 0.06}, {0.05, -0.035, 0.9},
               weathered(kWood, 0.2, 0.7));
    }
    addQuad(mesh,  // boards over the rafters
            {slope(lowEaves, -0.03, 0), slope(highEaves, -0.03, 0),
             slope(highEaves + 0.8 * highSpread, -0.03, 0.8),
             slope(lowEaves - 0.8 * lowSpread, -0.03, 0.8)},
            plain(tinted(kWood, 0.1, 0.8)));

    const double ridge = kEaves + (kShell + kOverhang) * std::tan(kSlope);
    if (lowGable || highGable) {
        const Imath::V2d gable[] = {
            {-kOverhang, kEaves - 0.05}, {kShell, kEaves - 0.05}, {kShell, ridge - 0.05}};
        const Placement wall{side.at(lowGable ? low + 0.02 : high - 0.22, 0, 0), side.at.z,
                             side.at.y, -side.at.x};
        addPrism(mesh, moved(wall, 0, 0, -0.2), gable, 0.2, weathered(kPlaster, 0.16, 1.0));
    }
    const double reach = end + kShell;
    addPatch(
        mesh, 12, 6,
        [&](double u, double v) {
            return side.at(-reach + 2 * reach * u, -0.1 + (ridge + 0.12) * v, kShell);
        },
        weathered(kPlaster, 0.15, 1.2));
    const int caps = static_cast<int>(2 * reach / 0.4);
    for (int i = 0; i < caps; ++i) {
        const double x = -reach + 2 * reach * (i + 0.5) / caps;
        const Placement cap{side.at(x - 0.22, ridge - 0.05, kShell), -side.at.z, side.at.y,
                            side.at.x};
        addTile(mesh, {cap.origin, cap.x * 1.25, cap.y * 1.25, cap.z},
                tinted(kTerracotta, 0.25, noise(i, 9)));
    }
}

void addTower(SetMesh& mesh) {
    const Placement at{Vec3d(-11.3, 0, -8.6), Vec3d(1, 0, 0), Vec3d(0, 1, 0), Vec3d(0, 0, 1)};
    constexpr double kHalf = 1.6;
    constexpr double kBelfry = 12.2;
    const Arch arch{kHalf / 2, 0.5, kBelfry + 1.45, kBelfry + 2.35, 0.3, 12};
    const Paint paint = weathered(kPlaster, 0.17, 1.0);
    const Paint stone = weathered(kStone, 0.12, 0.8);
    addBox(mesh, at, {-kHalf, 6, -kHalf}, {kHalf, kBelfry, kHalf}, paint);
    addSlab(mesh, at, {-kHalf - 0.14, kBelfry - 0.12, -kHalf - 0.14},
            {kHalf + 0.14, kBelfry + 0.06, kHalf + 0.14}, 0.04, stone);
    for (int i = 0; i < 4; ++i) {
        const Placement face = moved(at, 0, 0, 0, i * kPi / 2);
        for (const double x : {-kHalf / 2, kHalf / 2}) {
            const Placement front = moved(face, x, 0, -kHalf + 0.15);
            addArchWall(mesh, front, arch, paint);
            addArchivolt(mesh, front, arch, -0.15, 0.12, stone);
        }
        addBox(mesh, moved(face, -kHalf + 0.15, 0, -kHalf + 0.15), {-0.17, kBelfry, -0.17},
               {0.17, kBelfry + 2.35, 0.17}, stone);
        addBox(mesh, moved(face, 0, 0, -kHalf + 0.15), {-0.12, kBelfry, -0.12},
               {0.12, kBelfry + 1.45, 0.12}, stone);
        const double eave = kHalf + 0.35;
        const double slope = 0.46;
        addTiles(mesh, {slopeFrame(face, kBelfry + 2.55, -eave, slope), eave / std::cos(slope),
                        -eave, eave, -std::cos(slope), -std::cos(slope)});
    }
    addBox(mesh, at, {-kHalf - 0.2, kBelfry + 2.33, -kHalf - 0.2},
           {kHalf + 0.2, kBelfry + 2.56, kHalf + 0.2}, stone);
    const double peak = kBelfry + 2.55 + (kHalf + 0.35) * std::tan(0.46);
    const Imath::V2d finial[] = {{0.13, peak - 0.1},  {0.1, peak + 0.1},   {0.05, peak + 0.16},
                                 {0.12, peak + 0.26}, {0.14, peak + 0.36}, {0.1, peak + 0.47},
                                 {0.03, peak + 0.54}, {0.015, peak + 1.0}, {0, peak + 1.02}};
    addLathe(mesh, at, finial, 12, plain(kGold, Finish::gilded));
}

}  // namespace shadowcache::scenes::courtyard
