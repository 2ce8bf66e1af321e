#include "bake/core/depth_layers.h"

#include <algorithm>
#include <limits>

namespace shadowcache {

namespace {

/// Least cosine between a piece's normal and the mean of a side that may have layers: rounded edges
/// may, what folds back may not.
constexpr float kLeastLayerAgreement = 0.6f;
/// Least distance of two layers, in spacings.
constexpr double kLeastGap = 5e-3;
/// Least area of a layer, in squares of the spacing: leaves of a tree are none.
constexpr double kLeastLayerArea = 0.2;

/// What a piece takes up along the side's normal.
struct Extent {
    double low = 0, high = 0;
    double area = 0;
    std::size_t piece = 0;
};

/// The pieces' mean normal; zero if one of them differs too much from it.
Vec3d commonNormal(const std::vector<Piece>& pieces) {
    Vec3d sum(0, 0, 0);
    for (const Piece& p : pieces) sum += Vec3d(p.normal) * static_cast<double>(p.area);
    const Vec3d mean = sum.normalized();
    for (const Piece& p : pieces)
        if (p.normal.dot(Vec3f(mean)) < kLeastLayerAgreement) return Vec3d(0, 0, 0);
    return mean;
}

/// Extents of the pieces, the lowest first.
std::vector<Extent> extentsAlong(const Vec3d& normal, const TriangleMesh& mesh, const Box& voxel,
                                 const std::vector<Piece>& pieces) {
    std::vector<Extent> extents;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        const Polygon polygon = clipToBox(mesh, pieces[i].triangle, voxel);
        Extent e{std::numeric_limits<double>::max(), std::numeric_limits<double>::lowest(),
                 static_cast<double>(pieces[i].area), i};
        for (std::size_t k = 0; k < polygon.count; ++k) {
            const double height = normal.dot(polygon.corner[k] - voxel.center);
            e.low = std::min(e.low, height);
            e.high = std::max(e.high, height);
        }
        // Rounding may leave nothing of a sliver.
        if (polygon.count == 0) e.low = e.high = 0;
        extents.push_back(e);
    }
    std::sort(extents.begin(), extents.end(),
              [](const Extent& a, const Extent& b) { return a.low < b.low; });
    return extents;
}

/// Indices of the extents that begin a new layer, and their number at the end. The widest gaps come
/// first, as long as what they part is large enough.
std::vector<std::size_t> layerBegins(const std::vector<Extent>& extents, double leastGap,
                                     double leastArea) {
    struct Gap {
        double width;
        std::size_t after;
    };
    std::vector<Gap> gaps;
    std::vector<double> areaBefore{0};
    double end = extents[0].high;
    for (std::size_t i = 0; i < extents.size(); ++i) {
        areaBefore.push_back(areaBefore.back() + extents[i].area);
        if (extents[i].low - end > leastGap) gaps.push_back({extents[i].low - end, i});
        end = std::max(end, extents[i].high);
    }
    std::stable_sort(gaps.begin(), gaps.end(),
                     [](const Gap& a, const Gap& b) { return a.width > b.width; });
    std::vector<std::size_t> begins{0, extents.size()};
    for (const Gap& gap : gaps) {
        const auto next = std::lower_bound(begins.begin(), begins.end(), gap.after);
        if (areaBefore[gap.after] - areaBefore[*(next - 1)] >= leastArea &&
            areaBefore[*next] - areaBefore[gap.after] >= leastArea)
            begins.insert(next, gap.after);
        if (begins.size() > static_cast<std::size_t>(kMaxDepthLayers)) break;
    }
    return begins;
}

}  // namespace

std::vector<std::vector<Piece>> splitDepthLayers(const TriangleMesh& mesh, const Box& voxel,
                                                 const std::vector<Piece>& pieces) {
    const Vec3d normal = pieces.size() > 1 ? commonNormal(pieces) : Vec3d(0, 0, 0);
    if (normal == Vec3d(0, 0, 0)) return {pieces};
    const std::vector<Extent> extents = extentsAlong(normal, mesh, voxel, pieces);
    const double spacing = 2 * voxel.half.x;
    const std::vector<std::size_t> begins =
        layerBegins(extents, kLeastGap * spacing, kLeastLayerArea * spacing * spacing);
    std::vector<std::vector<Piece>> layers;
    for (std::size_t k = 0; k + 1 < begins.size(); ++k) {
        std::vector<std::size_t> members;
        for (std::size_t i = begins[k]; i < begins[k + 1]; ++i) members.push_back(extents[i].piece);
        std::sort(members.begin(), members.end());
        layers.emplace_back();
        for (const std::size_t i : members) layers.back().push_back(pieces[i]);
    }
    return layers;
}

}  // namespace shadowcache
