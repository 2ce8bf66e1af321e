#include <fmt/core.h>

#include <cmath>

#include "common/base/error.h"
#include "common/random/sequence.h"
#include "scenes/ply_writer.h"
#include "scenes/sets.h"

namespace shadowcache::scenes {
namespace {

constexpr std::int64_t kPieceTriangles = 1280;  // of one rock, or of one tuft of as many blades
constexpr double kPieceArea = 0.8;              // square metres of ground to each piece
constexpr int kBlades = static_cast<int>(kPieceTriangles / 2);

struct Layout {
    std::int64_t pieces;
    std::int64_t ground;  ///< cells along a side of the ground
    std::int64_t blades;  ///< single triangles that make the number exact
    double side;          ///< metres
};

Layout layout(std::int64_t triangles) {
    Layout l{};
    l.ground = static_cast<std::int64_t>(std::sqrt(0.1 * static_cast<double>(triangles) / 2));
    const std::int64_t rest = triangles - 2 * l.ground * l.ground;
    l.pieces = rest / kPieceTriangles;
    l.blades = rest % kPieceTriangles;
    l.side = std::sqrt(static_cast<double>(l.pieces) * kPieceArea);
    return l;
}

double groundHeight(double x, double z) {
    return 0.5 * smoothNoise({x / 4, 0, z / 4}) + 0.08 * smoothNoise({x, 7, z});
}

Vec3d pieceCenter(const Layout& l, std::int64_t piece) {
    const double x = (noise(piece, 1) - 0.5) * l.side;
    const double z = (noise(piece, 2) - 0.5) * l.side;
    return {x, groundHeight(x, z), z};
}

void addGround(SetMesh& mesh, const Layout& l, std::int64_t row) {
    const double step = l.side / static_cast<double>(l.ground);
    addPatch(
        mesh, 1, static_cast<int>(l.ground),
        [&](double u, double v) {
            const double x = (v - 0.5) * l.side;
            const double z = (static_cast<double>(row) + u) * step - l.side / 2;
            return Vec3d(x, groundHeight(x, z), z);
        },
        weathered({0.24f, 0.17f, 0.10f}, 0.3, 0.9));
}

/// A rough sphere of 17 x 40 cells: 1280 triangles, as the poles' cells have but one each.
void addRock(SetMesh& mesh, const Layout& l, std::int64_t piece) {
    const Vec3d center = pieceCenter(l, piece);
    const double size = 0.12 + 0.35 * std::pow(noise(piece, 3), 3);
    const Vec3d shift(static_cast<double>(piece % 1000) * 3, 0, 0);
    const Paint paint = weathered(tinted({0.36f, 0.34f, 0.31f}, 0.3, noise(piece, 4)), 0.25, 0.1);
    addPatch(
        mesh, 17, 40,
        [&](double u, double v) {
            const double polar = kPi * u;
            const double angle = 2 * kPi * (v < 1 ? v : 0);
            const Vec3d d(std::sin(polar) * std::cos(angle), -std::cos(polar),
                          std::sin(polar) * std::sin(angle));
            const double r = size * (0.65 + 0.5 * smoothNoise(d * 1.6 + shift) +
                                     0.15 * smoothNoise(d * 6.0 + shift));
            return center + Vec3d(d.x * r, 0.7 * d.y * r, d.z * r);
        },
        paint);
}

void addBlade(SetMesh& mesh, const Vec3d& root, std::int64_t a, std::int64_t b, int parts) {
    const double angle = 2 * kPi * noise(a, b, 5);
    const Vec3d side(std::cos(angle), 0, std::sin(angle));
    const double height = 0.10 + 0.16 * noise(a, b, 6);
    const Vec3d lean(0.1 * (noise(a, b, 7) - 0.5), 0, 0.1 * (noise(a, b, 8) - 0.5));
    const Rgb color = tinted({0.11f, 0.22f, 0.05f}, 0.4, noise(a, b, 9));
    const int p = mesh.addVertex(root - side * 0.005, color);
    const int q = mesh.addVertex(root + side * 0.005, color);
    const int tip = mesh.addVertex(root + Vec3d(0, height, 0) + lean, color);
    mesh.addTriangle(p, q, tip);
    if (parts == 2) {  // bends over
        const int end =
            mesh.addVertex(root + Vec3d(0, height * 1.1, 0) + lean * 3.0 + side * 0.02, color);
        mesh.addTriangle(q, end, tip);
    }
}

void addTuft(SetMesh& mesh, const Layout& l, std::int64_t piece) {
    const Vec3d center = pieceCenter(l, piece);
    for (std::int64_t i = 0; i < kBlades; ++i) {
        const double r = 0.45 * std::sqrt(noise(piece, i, 10));
        const double angle = 2 * kPi * noise(piece, i, 11);
        const double x = center.x + r * std::cos(angle);
        const double z = center.z + r * std::sin(angle);
        addBlade(mesh, {x, groundHeight(x, z) - 0.005, z}, piece, i, 2);
    }
}

/// Calls `use` with every part of the set in turn; the same parts each time.
template <class Use>
void forEachPart(const Layout& l, const Use& use) {
    SetMesh part;
    const auto flush = [&] {
        use(part);
        part.positions.clear();
        part.colors.clear();
        part.triangles.clear();
    };
    for (std::int64_t row = 0; row < l.ground; ++row) {
        addGround(part, l, row);
        flush();
    }
    for (std::int64_t piece = 0; piece < l.pieces; ++piece) {
        piece % 4 == 0 ? addRock(part, l, piece) : addTuft(part, l, piece);
        flush();
    }
    for (std::int64_t i = 0; i < l.blades; ++i)
        addBlade(part, pieceCenter(l, l.pieces + i), l.pieces, i, 1);
    flush();
}

}  // namespace

void writeScatter(const std::filesystem::path& path, std::int64_t triangles) {
    if (triangles < kScatterMin || triangles > kScatterMax)
        throw Error(fmt::format("--triangles: found {}, expected {} to {}", triangles, kScatterMin,
                                kScatterMax));
    const Layout l = layout(triangles);
    const std::int64_t rocks = (l.pieces + 3) / 4;
    const std::int64_t vertices = 2 * l.ground * (l.ground + 1) + rocks * 18 * 41 +
                                  (l.pieces - rocks) * kBlades * 4 + l.blades * 3;
    PlyWriter writer(path, static_cast<std::uint64_t>(vertices),
                     static_cast<std::uint64_t>(triangles));
    forEachPart(l, [&](const SetMesh& part) {
        for (std::size_t i = 0; i < part.positions.size(); ++i)
            writer.vertex(part.positions[i], part.colors[i]);
    });
    std::int64_t base = 0;
    std::int64_t written = 0;
    forEachPart(l, [&](const SetMesh& part) {
        for (const Vec3i& t : part.triangles) writer.triangle(t + Vec3i(static_cast<int>(base)));
        base += static_cast<std::int64_t>(part.positions.size());
        written += static_cast<std::int64_t>(part.triangles.size());
    });
    writer.finish();
    if (written != triangles || base != vertices)
        throwFileError(path, fmt::format("{} triangles made, expected {}", written, triangles));
}

std::vector<CameraKey> scatterWalk(std::int64_t triangles) {
    const double side = layout(triangles).side;
    const double reach = std::min(0.3 * side, 8.0);
    return {{{-reach, 2.2, reach}, {0, 0.2, 0}},
            {{0, 1.8, reach * 0.8}, {0.5, 0.2, -1}},
            {{reach, 1.6, reach}, {0, 0.2, 0}}};
}

}  // namespace shadowcache::scenes
