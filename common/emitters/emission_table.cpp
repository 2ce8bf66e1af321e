#include "common/emitters/emission_table.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/emitters/emitted.h"
#include "common/mesh/looks.h"
#include "common/mesh/placed_mesh.h"

namespace shadowcache {

namespace {

/// Fewer cells along a side say no more than a few points do.
constexpr double kLeastSide = 6;

/// By how much the second moment of even points has to be above that of points by cells: half of
/// the points are even ones in any case.
constexpr double kLeastTableGain = 2;

/// What points beside a cell emit counts as much for it as this share of its own: a bright spot may
/// reach into it between those that were looked at.
constexpr double kOfNeighbors = 0.1;

/// Length of the longest side in texels of the pictures that decide what a triangle emits.
double texelsAlong(const TriangleMesh& mesh, std::uint32_t triangle) {
    const Material& material = *materialOf(mesh, triangle);
    const auto along = [&](const TextureSlot& slot) {
        double longest = 0;
        if (slot.texture < 0) return longest;
        const Texture& picture = mesh.textures[static_cast<std::size_t>(slot.texture)];
        const std::array<Vec2f, 3> at = texturePlaces(mesh, triangle, slot.layer);
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec2f side = at[(k + 1) % 3] - at[k];
            longest = std::max(longest, std::hypot(static_cast<double>(side.x) * picture.width,
                                                   static_cast<double>(side.y) * picture.height));
        }
        return longest;
    };
    const bool byColor = material.finish.unlit || material.cutOut || material.blends;
    return std::max(along(material.finish.emissionTexture),
                    byColor ? along({material.texture, 0}) : 0.0);
}

double lightOf(const Rgb& c) {
    return static_cast<double>(brightness(c));
}

/// A corner of cells: what it emits, and the most of it and the corners beside it.
struct Corner {
    double emitted = 0, near = 0;
};

/// Row by row.
template <class EmittedAt>
std::vector<Corner> cornersOf(std::size_t side, const EmittedAt& at) {
    const std::size_t row = side + 1;
    std::vector<Corner> corners(row * row);
    const auto forEach = [&](const auto& use) {
        for (std::size_t j = 0; j <= side; ++j)
            for (std::size_t i = 0; i + j <= side; ++i) use(i, j, corners[j * row + i]);
    };
    forEach([&](std::size_t i, std::size_t j, Corner& corner) {
        corner.emitted = lightOf(at(static_cast<double>(i), static_cast<double>(j)));
    });
    forEach([&](std::size_t i, std::size_t j, Corner& corner) {
        for (std::size_t b = j > 0 ? j - 1 : 0; b <= std::min(j + 1, side); ++b)
            for (std::size_t a = i > 0 ? i - 1 : 0; a <= std::min(i + 1, side); ++a)
                corner.near = std::max(corner.near, corners[b * row + a].emitted);
    });
    return corners;
}

}  // namespace

std::optional<EmissionTable> EmissionTable::of(const TriangleMesh& mesh, std::uint32_t triangle,
                                               float most, std::size_t cells) {
    const double wanted = std::ceil(
        std::min(texelsAlong(mesh, triangle), std::floor(std::sqrt(static_cast<double>(cells)))));
    if (!(wanted >= kLeastSide)) return {};
    const auto side = static_cast<std::size_t>(wanted);
    EmissionTable table(side);
    const auto at = [&](double u, double v) {
        return emittedAt(mesh, triangle, static_cast<float>(u / wanted),
                         static_cast<float>(v / wanted));
    };
    const auto corners = cornersOf(side, at);
    const double count = wanted * wanted;
    std::vector<double> emitted(table.sums_.size());
    Vec3d sum(0, 0, 0);
    for (std::size_t n = 0; n < emitted.size(); ++n) {
        const Cell cell = table.cellOf(n);
        const std::size_t i = cell.across, j = cell.up, turned = cell.upper ? 1 : 0;
        if (i + j + turned >= side) continue;
        const double third = cell.upper ? 2.0 / 3 : 1.0 / 3;
        const Rgb middle = at(static_cast<double>(i) + third, static_cast<double>(j) + third);
        sum += Vec3d(middle);
        table.square_ += lightOf(middle) * lightOf(middle) / count;
        emitted[n] = 0.25 * lightOf(middle);
        double near = 0;
        for (const Corner& c :
             {corners[(j + turned) * (side + 1) + i + turned], corners[j * (side + 1) + i + 1],
              corners[(j + 1) * (side + 1) + i]}) {
            emitted[n] += 0.25 * c.emitted;
            near = std::max(near, c.near);
        }
        emitted[n] += kOfNeighbors * near;
    }
    table.mean_ = Rgb(sum / count);
    // What n points miss is about an n-th of the triangle at most, and mostly nothing.
    table.floor_ = 0.25f * most / static_cast<float>(count);
    double before = 0;
    for (std::size_t n = 0; n < emitted.size(); ++n) {
        const Cell cell = table.cellOf(n);
        if (cell.across + cell.up + (cell.upper ? 1 : 0) < side)
            before += emitted[n] + static_cast<double>(table.floor_);
        table.sums_[n] = before;
    }
    return table;
}

bool EmissionTable::pays() const {
    const double mean = lightOf(mean_);
    return square_ > kLeastTableGain * mean * mean;
}

EmissionTable::Cell EmissionTable::cellAt(double u, double v) const noexcept {
    const auto side = static_cast<double>(side_);
    // Of a triangle without area no number is to be had.
    const auto place = [&](double x) {
        return x > 0 ? static_cast<std::size_t>(std::min(x * side, side - 1)) : std::size_t{0};
    };
    Cell cell{place(u), place(v), false};
    // Rounding may put a place on the third side beyond it.
    while (cell.across + cell.up >= side_) (cell.across > cell.up ? cell.across : cell.up) -= 1;
    cell.upper =
        cell.across + cell.up + 1 < side_ &&
        u * side - static_cast<double>(cell.across) + v * side - static_cast<double>(cell.up) > 1;
    return cell;
}

double EmissionTable::chanceOf(std::size_t number) const noexcept {
    return (sums_[number] - (number > 0 ? sums_[number - 1] : 0)) / sums_.back();
}

EmitterPart EmissionTable::partOf(const EmitterPart& triangle, const Cell& cell) const noexcept {
    const Vec3d origin(triangle.corner[0]);
    const Vec3d first = (Vec3d(triangle.corner[1]) - origin) / static_cast<double>(side_);
    const Vec3d second = (Vec3d(triangle.corner[2]) - origin) / static_cast<double>(side_);
    const double sign = cell.upper ? -1 : 1;
    const Vec3d start = origin + first * static_cast<double>(cell.across + (cell.upper ? 1 : 0)) +
                        second * static_cast<double>(cell.up + (cell.upper ? 1 : 0));
    const auto scale = 1 / static_cast<float>(side_);
    EmitterPart part = triangle;
    part.corner = {Vec3f(start), Vec3f(start + first * sign), Vec3f(start + second * sign)};
    part.centre = Vec3f(start + (first + second) * (sign / 3));
    part.radius *= scale;
    part.size *= scale;
    part.area *= scale * scale;
    return part;
}

float EmissionTable::densityOf(const EmitterPart& triangle, const Receiver& at, const Cell& cell,
                               const Vec3f& position) const noexcept {
    const auto chance = static_cast<float>(chanceOf(numberOf(cell)));
    return 0.5f * (shadowcache::densityAt(triangle, at, position) +
                   chance * shadowcache::densityAt(partOf(triangle, cell), at, position));
}

EmitterPoint EmissionTable::sample(const EmitterPart& triangle, const Receiver& at, double u,
                                   double v) const noexcept {
    EmitterPoint point;
    Cell cell{};
    if (u < 0.5) {
        point = samplePoint(triangle, at, 2 * u, v);
        cell = cellAt(static_cast<double>(point.u), static_cast<double>(point.v));
    } else {
        const double wanted = (2 * u - 1) * sums_.back();
        const auto found = std::ranges::upper_bound(sums_, wanted);
        const auto number = static_cast<std::size_t>(
            std::min<std::ptrdiff_t>(found - sums_.begin(), std::ssize(sums_) - 1));
        cell = cellOf(number);
        const double within = (sums_[number] - wanted) / (chanceOf(number) * sums_.back());
        point =
            samplePoint(partOf(triangle, cell), at, std::clamp(1 - within, 0.0, 1 - 0x1p-53), v);
        const auto along = [&](std::size_t cells, float x) {
            const double whole = static_cast<double>(cells) +
                                 (cell.upper ? 1 - static_cast<double>(x) : static_cast<double>(x));
            return static_cast<float>(whole / static_cast<double>(side_));
        };
        point.u = along(cell.across, point.u);
        point.v = along(cell.up, point.v);
    }
    if (point.density > 0) point.density = densityOf(triangle, at, cell, point.position);
    return point;
}

float EmissionTable::densityAt(const EmitterPart& triangle, const Receiver& at,
                               const Vec3f& position) const noexcept {
    const Vec3d origin(triangle.corner[0]), place = Vec3d(position) - origin;
    const Vec3d first = Vec3d(triangle.corner[1]) - origin;
    const Vec3d second = Vec3d(triangle.corner[2]) - origin;
    const Vec3d across = first.cross(second);
    const double square = across.length2();
    const double u = place.cross(second).dot(across) / square;
    const double v = first.cross(place).dot(across) / square;
    return densityOf(triangle, at, cellAt(u, v), position);
}

}  // namespace shadowcache
