#include "bake/shot/shot_lookups.h"

#include <algorithm>
#include <bitset>
#include <cmath>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "common/base/parallel.h"
#include "common/base/progress.h"
#include "common/cache/lookup_weight.h"
#include "common/random/salts.h"
#include "common/shot/view.h"

namespace shadowcache {

namespace {

/// Camera rays of the first round; each later one has twice as many as the one before.
constexpr int kFirstRoundRays = 16384;
/// A round of whose rays a smaller share finds something new is the last.
constexpr double kLeastNewShare = 5e-4;
/// Camera rays of the last round, at most, as a multiple of the picture's pixels.
constexpr double kMostRaysAPixel = 2;

/// How far beyond the film's edge pixel filters reach. [pixels]
constexpr double kFilmBorder = 2;

constexpr std::size_t kRowsPerChunk = 4;

/// Level of the cells of the direction mesh by which the rays of a frame tell normals apart.
constexpr int kNormalLevel = 2;

using NormalSet = std::bitset<cellCount(kNormalLevel)>;

/// Cells of kNormalLevel whose lookups find most of what those of a cell do.
const std::vector<NormalSet>& cellsNear() {
    static const std::vector<NormalSet> kNear = [] {
        std::vector<Vec3d> center;
        for (std::uint32_t c = 0; c < cellCount(kNormalLevel); ++c)
            center.push_back(cellCenter(kNormalLevel, c));
        std::vector<NormalSet> near(center.size());
        for (std::size_t a = 0; a < center.size(); ++a)
            for (std::size_t b = 0; b < center.size(); ++b)
                near[a].set(b, agreementOf(Vec3f(center[a]), Vec3f(center[b])) > 0);
        return near;
    }();
    return kNear;
}

/// Looks at one frame.
class FrameLookups {
public:
    FrameLookups(const CameraMove& camera, const Scene& scene, const VoxelFrame& frame,
                 std::array<int, 2> size)
        : rays_(camera, static_cast<double>(size[0]) / size[1]),
          scene_(scene),
          frame_(frame),
          size_(size) {}

    LookupPlaces find() {
        const double most = kMostRaysAPixel * size_[0] * size_[1];
        std::uint64_t seed = 0;
        for (double rays = kFirstRoundRays;; rays *= 2) {
            const bool last = rays >= most;
            const double newShare = addRound(last ? most : rays, ++seed);
            if (last || newShare < kLeastNewShare) return std::move(places_);
        }
    }

private:
    /// What the rays of some rows of a round's grid meet.
    struct Part {
        std::vector<LookupPlaces::Place> seen;
        std::size_t newRays = 0;
    };

    /// Sends one ray through a random place of each cell of a grid over the film.
    ///
    /// @return share of the rays that meet something new
    double addRound(double rays, std::uint64_t seed) {
        const double aspect = static_cast<double>(size_[0]) / size_[1];
        const auto columns = static_cast<std::size_t>(std::ceil(std::sqrt(rays * aspect)));
        const auto rows = static_cast<std::size_t>(std::ceil(std::sqrt(rays / aspect)));
        std::vector<Part> parts((rows + kRowsPerChunk - 1) / kRowsPerChunk);
        parallelFor(rows, kRowsPerChunk, [&](const Chunk& chunk) {
            throwIfInterrupted();
            std::array<LookupRay, RayPacket::kSize> some;
            for (std::size_t row = chunk.begin; row < chunk.end; ++row)
                for (std::size_t first = 0; first < columns; first += some.size()) {
                    const std::size_t count = std::min(some.size(), columns - first);
                    for (std::size_t i = 0; i < count; ++i) {
                        const std::size_t column = first + i;
                        const std::uint64_t number = row * columns + column;
                        const double u = toUnit(hashWords(seed, BakeSalt::filmColumn, number));
                        const double v = toUnit(hashWords(seed, BakeSalt::filmRow, number));
                        const FilmPosition at =
                            onFilm((static_cast<double>(column) + u) / static_cast<double>(columns),
                                   (static_cast<double>(row) + v) / static_cast<double>(rows));
                        const std::uint64_t chance = hashWords(seed, BakeSalt::crossing, number);
                        some[i] = {rayThrough(at, seed, number),
                                   toUnitFloat(static_cast<std::uint32_t>(chance))};
                    }
                    look(std::span(some).first(count), parts[chunk.index]);
                }
        });
        std::size_t newRays = 0;
        std::vector<LookupPlaces::Place> places;
        for (const Part& part : parts) {
            newRays += part.newRays;
            for (const LookupPlaces::Place& place : part.seen)
                known_[place.voxelKey].set(place.normalCell(kNormalLevel));
            places.insert(places.end(), part.seen.begin(), part.seen.end());
        }
        places_.add(std::move(places));
        return static_cast<double>(newRays) / static_cast<double>(rows * columns);
    }

    /// @param x, y  in [0, 1] over the film and its border
    FilmPosition onFilm(double x, double y) const {
        const auto along = [](double share, int pixels) {
            return (share * (pixels + 2 * kFilmBorder) - kFilmBorder) / pixels;
        };
        return {along(x, size_[0]), along(y, size_[1])};
    }

    struct LookupRay {
        CameraRay ray;
        float chance;  ///< as CameraPacket has it
    };

    /// One of the rays that meet at a place of the film.
    CameraRay rayThrough(const FilmPosition& at, std::uint64_t seed, std::uint64_t number) const {
        if (!rays_.spread()) return rays_.through(at);
        return rays_.through(at, {toUnit(hashWords(seed, BakeSalt::lensU, number)),
                                  toUnit(hashWords(seed, BakeSalt::lensV, number)),
                                  toUnit(hashWords(seed, BakeSalt::shutterTime, number))});
    }

    /// @param rays  as many as a packet has, or fewer
    void look(std::span<const LookupRay> rays, Part& out) const {
        CameraPacket packet{};
        std::array<View, RayPacket::kSize> views;
        std::array<Hit, RayPacket::kSize> hits;
        for (std::size_t i = 0; i < rays.size(); ++i) {
            const CameraRay& ray = rays[i].ray;
            views[i].direction = Vec3f(ray.direction);
            packet.set(static_cast<int>(i), startIn(scene_, ray), views[i].direction,
                       rays[i].chance, ray.reach);
        }
        scene_.look(packet, static_cast<int>(rays.size()), kLeastOfPanes, hits.data());
        for (std::size_t i = 0; i < rays.size(); ++i) {
            views[i].hit = hits[i];
            note(views[i], out);
        }
    }

    void note(const View& view, Part& out) const {
        if (!view.hit.found) return;
        const Vec3d p = worldPosition(scene_, view.hit) / frame_.spacing();
        const Vec3d low(std::floor(p.x), std::floor(p.y), std::floor(p.z));
        const Vec3i voxel(low);
        // What moves may be far from the set.
        if (!frame_.holds(voxel)) return;
        const auto place =
            LookupPlaces::makePlace(frame_.key(voxel), Vec3f(p - low), view.geometricNormal());
        const auto known = known_.find(place.voxelKey);
        if (known == known_.end() ||
            (known->second & cellsNear()[place.normalCell(kNormalLevel)]).none())
            ++out.newRays;
        if (out.seen.empty() || out.seen.back() != place) out.seen.push_back(place);
    }

    const CameraRays rays_;
    const Scene& scene_;
    const VoxelFrame& frame_;
    const std::array<int, 2> size_;
    LookupPlaces places_;
    std::unordered_map<std::uint64_t, NormalSet> known_;  ///< by voxel: normals met
};

}  // namespace

LookupPlaces lookupsOf(const CameraMove& camera, const Scene& scene, const VoxelFrame& frame,
                       std::array<int, 2> size) {
    return FrameLookups(camera, scene, frame, size).find();
}

LookupPlaces lookupsOf(const Shot& shot, Scene& scene, const VoxelFrame& frame) {
    LookupPlaces all;
    Progress progress("look", std::max<std::size_t>(1, shot.frames.size()));
    for (const int number : shot.frames) {
        scene.setMoving(shot.moving.pose(number));
        all.add(lookupsOf(shot.camera.moveAt(number), scene, frame, shot.size).places());
        progress.add(1);
    }
    scene.setMoving(nullptr);
    return all;
}

}  // namespace shadowcache
