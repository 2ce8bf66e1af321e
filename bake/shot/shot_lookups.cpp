#include "bake/shot/shot_lookups.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "common/base/parallel.h"
#include "common/base/progress.h"
#include "common/base/tuned.h"
#include "common/random/salts.h"
#include "common/shot/view.h"

namespace shadowcache {

namespace {

/// Camera rays of the first round; each later one has twice as many as the one before.
SHADOWCACHE_TUNED(int, kFirstRoundRays, 16384);
/// A round of whose rays a smaller share finds something new is the last.
SHADOWCACHE_TUNED(double, kLeastNewShare, 5e-4);
/// Camera rays of the last round, at most, as a multiple of the picture's pixels.
SHADOWCACHE_TUNED(double, kMostRaysAPixel, 2);

/// How far beyond the film's edge pixel filters reach. [pixels]
constexpr double kFilmBorder = 2;

constexpr std::size_t kRowsPerChunk = 4;

/// Cells of kNormalLevel whose lookups find most of what those of a cell do.
const std::vector<NormalSet>& cellsNear() {
    static const std::vector<NormalSet> kNear = [] {
        std::vector<Vec3d> center;
        for (std::uint32_t c = 0; c < cellCount(kNormalLevel); ++c)
            center.push_back(cellCenter(kNormalLevel, c));
        std::vector<NormalSet> near(center.size());
        for (std::size_t a = 0; a < center.size(); ++a)
            for (std::size_t b = 0; b < center.size(); ++b)
                near[a].set(b, center[a].dot(center[b]) >= static_cast<double>(kMinAgreement));
        return near;
    }();
    return kNear;
}

/// The eight voxels that a lookup at a place goes to.
struct Lookup {
    Vec3i low;
    std::uint32_t normal;  ///< cell of kNormalLevel
    bool operator==(const Lookup&) const = default;

    /// Calls `visit` with the key of each voxel that the frame holds.
    template <class Visit>
    void visitVoxels(const VoxelFrame& frame, const Visit& visit) const {
        for (int k = 0; k < 8; ++k)
            if (const Vec3i voxel = low + Vec3i(k & 1, k >> 1 & 1, k >> 2); frame.holds(voxel))
                visit(frame.key(voxel));
    }
};

/// Looks at one frame.
class FrameLookups {
public:
    FrameLookups(const Camera& camera, const Scene& scene, const VoxelFrame& frame,
                 std::array<int, 2> size)
        : rays_(camera, static_cast<double>(size[0]) / size[1]),
          scene_(scene),
          frame_(frame),
          size_(size) {}

    VoxelLookups find() const {
        VoxelLookups found;
        const double most = kMostRaysAPixel * size_[0] * size_[1];
        std::uint64_t seed = 0;
        for (double rays = kFirstRoundRays;; rays *= 2) {
            const bool last = rays >= most;
            const double newShare = addRound(last ? most : rays, ++seed, found);
            if (last || newShare < kLeastNewShare) return found;
        }
    }

private:
    /// What the rays of some rows of a round's grid look up.
    struct Part {
        std::vector<Lookup> lookups;
        std::size_t newRays = 0;
    };

    /// Sends one ray through a random place of each cell of a grid over the film.
    ///
    /// @return share of the rays that find something new
    double addRound(double rays, std::uint64_t seed, VoxelLookups& found) const {
        const double aspect = static_cast<double>(size_[0]) / size_[1];
        const auto columns = static_cast<std::size_t>(std::ceil(std::sqrt(rays * aspect)));
        const auto rows = static_cast<std::size_t>(std::ceil(std::sqrt(rays / aspect)));
        std::vector<Part> parts((rows + kRowsPerChunk - 1) / kRowsPerChunk);
        parallelFor(rows, kRowsPerChunk, [&](const Chunk& chunk) {
            throwIfInterrupted();
            for (std::size_t row = chunk.begin; row < chunk.end; ++row)
                for (std::size_t column = 0; column < columns; ++column) {
                    const std::uint64_t number = row * columns + column;
                    const double u = toUnit(hashWords(seed, BakeSalt::filmColumn, number));
                    const double v = toUnit(hashWords(seed, BakeSalt::filmRow, number));
                    look((static_cast<double>(column) + u) / static_cast<double>(columns),
                         (static_cast<double>(row) + v) / static_cast<double>(rows), found,
                         parts[chunk.index]);
                }
        });
        std::size_t newRays = 0;
        for (const Part& part : parts) {
            newRays += part.newRays;
            for (const Lookup& lookup : part.lookups)
                lookup.visitVoxels(frame_,
                                   [&](std::uint64_t key) { found.add(key, lookup.normal); });
        }
        return static_cast<double>(newRays) / static_cast<double>(rows * columns);
    }

    /// @param x, y  in [0, 1] over the film and its border
    void look(double x, double y, const VoxelLookups& known, Part& out) const {
        const auto onFilm = [](double share, int pixels) {
            return (share * (pixels + 2 * kFilmBorder) - kFilmBorder) / pixels;
        };
        const View view = lookThrough(rays_, scene_, {onFilm(x, size_[0]), onFilm(y, size_[1])});
        if (!view.hit.found) return;
        const Vec3d p = worldPosition(scene_, view.hit) / frame_.spacing();
        const Lookup lookup{{static_cast<int>(std::floor(p.x)), static_cast<int>(std::floor(p.y)),
                             static_cast<int>(std::floor(p.z))},
                            locateCell(kNormalLevel, Vec3d(view.normal()))};
        if (isNew(lookup, known)) ++out.newRays;
        if (out.lookups.empty() || out.lookups.back() != lookup) out.lookups.push_back(lookup);
    }

    /// Whether the items of one of its voxels would likely be missing.
    bool isNew(const Lookup& lookup, const VoxelLookups& known) const {
        bool isNew = false;
        lookup.visitVoxels(frame_, [&](std::uint64_t key) {
            const NormalSet* normals = known.find(key);
            isNew = isNew || !normals || (*normals & cellsNear()[lookup.normal]).none();
        });
        return isNew;
    }

    const CameraRays rays_;
    const Scene& scene_;
    const VoxelFrame& frame_;
    const std::array<int, 2> size_;
};

}  // namespace

VoxelLookups lookupsOf(const Shot& shot, Scene& scene, const VoxelFrame& frame) {
    VoxelLookups all;
    Progress progress("look", std::max<std::size_t>(1, shot.frames.size()));
    for (const int number : shot.frames) {
        scene.setMoving(shot.moving.pose(number));
        all.add(FrameLookups(shot.camera.at(number), scene, frame, shot.size).find());
        progress.add(1);
    }
    scene.setMoving(nullptr);
    return all;
}

}  // namespace shadowcache
