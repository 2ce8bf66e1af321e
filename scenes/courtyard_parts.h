#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "scenes/geometry.h"

/// The courtyard's parts, one function each. The court is 18 x 12 m with its centre at the origin;
/// four sides of arches in two storeys surround it. A side has its own frame: x along the side, y
/// up, z out of the court; z = 0 is the line of the columns.
namespace shadowcache::scenes::courtyard {

inline constexpr double kHalfX = 9;  // of the court, to the line of the columns
inline constexpr double kHalfZ = 6;
inline constexpr double kBay = 3;      // from column to column, ground floor; half that above
inline constexpr double kDepth = 3.2;  // of the arcades
inline constexpr double kShell = 3.5;  // where the outer wall stands
inline constexpr double kFloor = 0.3;  // heights
inline constexpr double kSpring = 2.75;
inline constexpr double kWallTop = 4.45;
inline constexpr double kUpperFloor = 4.75;
inline constexpr double kRail = 5.65;
inline constexpr double kUpperSpring = 7.2;
inline constexpr double kUpperTop = 8.05;
inline constexpr double kEaves = 8.42;
inline constexpr double kWallHalf = 0.22;  // half the thickness of the arcade walls
inline constexpr double kRoomHalf = 3;     // the room takes the west side's two middle bays
inline constexpr double kRoomDepth = 5.2;
inline constexpr double kLandingLow = -1.5;  // x where the stair reaches the north gallery
inline constexpr double kLandingHigh = 0;

inline const Rgb kPlaster{0.66f, 0.49f, 0.29f};
inline const Rgb kStone{0.62f, 0.56f, 0.47f};
inline const Rgb kSlab{0.47f, 0.43f, 0.36f};
inline const Rgb kCobble{0.30f, 0.27f, 0.235f};
inline const Rgb kTerracotta{0.44f, 0.165f, 0.085f};
inline const Rgb kWood{0.19f, 0.105f, 0.055f};
inline const Rgb kShutter{0.085f, 0.19f, 0.17f};
inline const Rgb kBronze{0.50f, 0.34f, 0.20f};
inline const Rgb kGold{0.86f, 0.60f, 0.24f};
inline const Rgb kWater{0.04f, 0.115f, 0.125f};

enum class Facing { south, east, north, west };

struct Side {
    Facing facing;
    Placement at;
    int bays;

    double half() const { return bays * kBay / 2; }
    double bayCenter(int bay) const { return -half() + (bay + 0.5) * kBay; }
    /// Whether the bay is walled up because the room lies behind it.
    bool isRoom(int bay) const {
        return facing == Facing::west && std::abs(bayCenter(bay)) < kRoomHalf;
    }
};

std::array<Side, 4> sides();

/// Wall with a round arch through it, centred on the frame's y, from the springing to `top`; its
/// thickness reaches from z = -thickness/2 to +thickness/2.
struct Arch {
    double halfWidth;  ///< of the wall
    double radius;     ///< of the opening
    double spring;
    double top;
    double thickness;
    int segments;
};
void addArchWall(SetMesh& mesh, const Placement& at, const Arch& arch, const Paint& paint);

/// Moulding round the arch, standing out of the face at z = `face` toward -z.
void addArchivolt(SetMesh& mesh, const Placement& at, const Arch& arch, double face, double width,
                  const Paint& paint);

/// Wall between z0 and z1 over [x0, x1] x [y0, y1] with a rectangular hole.
struct Opening {
    double x0, x1, y0, y1;
};
void addPiercedWall(SetMesh& mesh, const Placement& at, const Opening& wall, const Opening& hole,
                    double z0, double z1, const Paint& paint);

void addGroundArcade(SetMesh& mesh, const Side& side);
void addGallery(SetMesh& mesh, const Side& side);
/// Roof of the east side, which has one storey: the low sun comes in over it.
void addTerrace(SetMesh& mesh, const Side& side);
void addRoof(SetMesh& mesh, const Side& side);
void addCorners(SetMesh& mesh);
void addTower(SetMesh& mesh);
void addPavement(SetMesh& mesh);
void addFountain(SetMesh& mesh);
void addStair(SetMesh& mesh);
void addBench(SetMesh& mesh, const Placement& at);
/// Citrus tree in a pot; `seed` makes each one different.
void addTree(SetMesh& mesh, const Placement& at, std::int64_t seed);
/// Low box with a clipped hedge.
void addHedge(SetMesh& mesh, const Placement& at, double length, std::int64_t seed);
/// The room's window, in the frame of its bay.
inline constexpr Opening kWindow{-0.65, 0.65, 1.15, 2.75};
void addRoom(SetMesh& mesh);
/// Lanterns, the room's lamp, the window's pane.
void addLights(SetMesh& mesh);

}  // namespace shadowcache::scenes::courtyard
