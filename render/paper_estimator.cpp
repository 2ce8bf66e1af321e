// The estimator of the paper: importance constant over the triangles of an adaptive triangulation
// of the map, tabulated diffuse convolutions, clipping to the hemisphere, cached visibility. [paper
// 4]

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/parallel.h"
#include "common/sequence.h"
#include "common/spherical_polygon.h"
#include "render/estimators.h"
#include "render/pooled_visibility.h"
#include "render/triangulation.h"

namespace shadowcache {

namespace {

/// Triangles' diffuse convolutions I_i(n), tabulated over the normal. [paper 4.2]
class ConvolutionTable {
public:
    static constexpr std::size_t kPolar = 32, kAzimuth = 64;

    ConvolutionTable(const Environment& environment, const std::vector<MapTriangle>& triangles)
        : count_(triangles.size()), values_(count_ * kPolar * kAzimuth) {
        parallelFor(kPolar * kAzimuth, 8, [&](const Chunk& chunk) {
            for (std::size_t node = chunk.begin; node < chunk.end; ++node)
                for (std::size_t i = 0; i < count_; ++i)
                    values_[node * count_ + i] =
                        static_cast<float>(convolve(environment, triangles[i], nodeNormal(node)));
        });
    }

    /// I_i(n) of all triangles, bilinear between the table's normals.
    void evaluate(const Vec3f& n, std::vector<float>& out) const {
        const double polar = std::acos(std::clamp(static_cast<double>(n.y), -1.0, 1.0));
        double azimuth = std::atan2(static_cast<double>(n.x), static_cast<double>(n.z)) / (2 * kPi);
        azimuth -= std::floor(azimuth);
        const double y = polar / kPi * (kPolar - 1), x = azimuth * kAzimuth;
        const std::size_t y0 = std::min(static_cast<std::size_t>(y), kPolar - 2);
        const std::size_t x0 = static_cast<std::size_t>(x) % kAzimuth, x1 = (x0 + 1) % kAzimuth;
        const auto fy = static_cast<float>(y - static_cast<double>(y0)),
                   fx = static_cast<float>(x - std::floor(x));
        const float* a = row(y0, x0);
        const float* b = row(y0, x1);
        const float* c = row(y0 + 1, x0);
        const float* d = row(y0 + 1, x1);
        out.resize(count_);
        for (std::size_t i = 0; i < count_; ++i)
            out[i] = (1 - fy) * ((1 - fx) * a[i] + fx * b[i]) + fy * ((1 - fx) * c[i] + fx * d[i]);
    }

private:
    static Vec3d nodeNormal(std::size_t node) {
        const std::size_t row = node / kAzimuth, column = node % kAzimuth;
        const double polar = kPi * static_cast<double>(row) / (kPolar - 1);
        const double azimuth = 2 * kPi * static_cast<double>(column) / kAzimuth;
        return {std::sin(polar) * std::sin(azimuth), std::cos(polar),
                std::sin(polar) * std::cos(azimuth)};
    }

    static double convolve(const Environment& environment, const MapTriangle& t, const Vec3d& n) {
        if (t.level <= Environment::kLevel) return convolveCell(environment, t.level, t.cell, n);
        // Finer than the order of the texels: one cosine for all of the triangle.
        const double height = n.dot(t.axis), sine = std::sin(t.radius);
        if (height >= sine) return std::max(0.0, n.dot(t.flux));
        return height <= -sine ? 0 : t.power * std::max(height, sine / 4);
    }

    /// Whole cells by their moments, texels one by one in the finest cells on the horizon.
    static double convolveCell(const Environment& environment, int level, std::uint32_t cell,
                               const Vec3d& n) {
        const CellMoments& m = environment.cells(level, cell / CellMoments::kSize);
        const std::uint32_t k = cell % CellMoments::kSize;
        const Vec3d axis(Vec3f(m.axis[0][k], m.axis[1][k], m.axis[2][k]));
        const double height = n.dot(axis);
        const auto sine = static_cast<double>(m.sinRadius[k]);
        if (height <= -sine || m.power[k] <= 0) return 0;
        double sum = 0;
        if (height >= sine) {
            const Rgb& weights = environment.luminanceWeights();
            for (int c = 0; c < 3; ++c)
                sum += static_cast<double>(weights[c]) *
                       n.dot(Vec3d(Vec3f(m.flux[c][0][k], m.flux[c][1][k], m.flux[c][2][k])));
            return std::max(0.0, sum);
        }
        if (level < Environment::kLevel) {
            for (std::uint32_t child = 4 * cell; child < 4 * cell + 4; ++child)
                sum += convolveCell(environment, level + 1, child, n);
            return sum;
        }
        const auto [begin, end] = environment.texelsOf(cell);
        for (std::uint32_t i = begin; i < end; ++i) {
            const Environment::Texel texel = environment.texel(i);
            sum += std::max(0.0, n.dot(Vec3d(texel.center))) *
                   static_cast<double>(environment.luminance(texel.radiance) * texel.solidAngle);
        }
        return sum;
    }

    const float* row(std::size_t y, std::size_t x) const {
        return values_.data() + (y * kAzimuth + x) * count_;
    }

    std::size_t count_;
    std::vector<float> values_;
};

/// What the cache knows of a cell of any level.
struct CellVisibility {
    float ratio = 1;
    float rays = 0;
};

CellVisibility lookUp(const PooledBlock& block, int i) {
    if (block.weight[i] <= 0) return {};
    return {block.ratio(i), block.effectiveRays(i)};
}

/// Mean over `count` cells from i on.
CellVisibility average(const PooledBlock& block, int i, int count) {
    CellVisibility sum{0, 0};
    int known = 0;
    for (int k = i; k < i + count; ++k) {
        const CellVisibility v = lookUp(block, k);
        if (v.rays <= 0) continue;
        sum.ratio += v.ratio;
        sum.rays += v.rays;
        ++known;
    }
    return known ? CellVisibility{sum.ratio / static_cast<float>(known), sum.rays}
                 : CellVisibility{};
}

/// The finest counts of a cell that the pooled items have.
CellVisibility visibilityOf(const PooledVisibility& pooled, int level, std::uint32_t cell) {
    const int base = pooled.tiers().baseLevel();
    if (level < base)
        return average(pooled.base(4 * cell / kBlockCells),
                       static_cast<int>(4 * cell % kBlockCells), 4);
    std::uint32_t at = ancestorCell(cell, level, base);
    CellVisibility found =
        lookUp(pooled.base(at / kBlockCells), static_cast<int>(at % kBlockCells));
    for (int tier = 0; tier < pooled.tiers().refinements(); ++tier) {
        const int finer = base + 2 * (tier + 1);
        const PooledBlock* block = pooled.children(tier, at);
        if (!block || level < finer - 1) break;
        if (level == finer - 1) return average(*block, static_cast<int>(cell % 4) * 4, 4);
        at = ancestorCell(cell, level, finer);
        found = lookUp(*block, static_cast<int>(at % kBlockCells));
    }
    return found;
}

/// A triangle of the tessellated hemisphere.
struct Piece {
    SphericalTriangle corners;
    double area;
    double weight;  ///< W
};

struct PaperWorkspace final : Workspace {
    std::optional<ShadowCache::Reader> reader;
    std::optional<PooledVisibility> pooled;
    std::vector<ItemView> items;
    std::vector<float> convolution;
    std::vector<Piece> pieces;
    std::vector<double> cdf;
};

class Paper final : public Estimator {
public:
    explicit Paper(const EstimatorContext& context)
        : Estimator(context),
          triangles_(triangulate(context.environment, context.options.triangles,
                                 context.options.minLevel, context.options.maxLevel)),
          table_(context.environment, triangles_) {}

    std::unique_ptr<Workspace> makeWorkspace() const override {
        auto w = std::make_unique<PaperWorkspace>();
        if (context_.cache) {
            w->reader.emplace(*context_.cache);
            w->pooled.emplace(context_.cache->header().tiers());
            w->items.resize(ShadowCache::kMaxItems);
        }
        return w;
    }

private:
    std::vector<MapTriangle> triangles_;
    ConvolutionTable table_;

    Rgb prepare(const ShadingPoint& point, int samples, Workspace& workspace) const override {
        auto& w = static_cast<PaperWorkspace&>(workspace);
        buildImportance(point, w);
        const double total = w.cdf.empty() ? 0.0 : w.cdf.back();
        if (!(total > 0)) return {0, 0, 0};
        const auto u = w.numbers(context_.options.sequence, point.seed, 0, samples);
        const auto v = w.numbers(context_.options.sequence, point.seed, 1, samples);
        for (std::size_t j = 0; j < u.size(); ++j) {
            // The lower bits come from a hash: 32 bits would be few for a large table.
            const double x = (static_cast<double>(u[j]) + toUnit(hashWords(point.seed, 81, j))) *
                             0x1p-32 * total;
            auto i = static_cast<std::size_t>(std::upper_bound(w.cdf.begin(), w.cdf.end(), x) -
                                              w.cdf.begin());
            i = std::min(i, w.pieces.size() - 1);
            const Piece& piece = w.pieces[i];
            const double coordinate = std::clamp((x - (w.cdf[i] - piece.weight)) / piece.weight,
                                                 0.0, 0x1.fffffffffffffp-1);
            const Vec3f direction(
                sampleDirection(piece.corners, coordinate, static_cast<double>(toUnitFloat(v[j]))));
            const float cosine = direction.dot(point.normal);
            if (cosine <= 0) {
                w.samples.addZero();
                continue;
            }
            const double density = piece.weight / (total * piece.area);
            w.samples.add(direction, context_.environment.radiance(direction) *
                                         (cosine / static_cast<float>(density * samples)));
        }
        w.samples.endGroup();
        return {0, 0, 0};
    }

    /// W_i of all triangles, clipped to the hemisphere, and their running sum.
    void buildImportance(const ShadingPoint& point, PaperWorkspace& w) const {
        if (w.reader) {
            const int found = w.reader->gather(point.position, point.normal, w.items);
            w.pooled->pool(std::span(w.items).first(static_cast<std::size_t>(found)));
        }
        table_.evaluate(point.normal, w.convolution);
        w.pieces.clear();
        w.cdf.clear();
        const Vec3d n(point.normal);
        for (std::size_t i = 0; i < triangles_.size(); ++i) {
            const MapTriangle& t = triangles_[i];
            const double height = n.dot(t.axis), sine = std::sin(t.radius);
            if (height <= -sine || (t.power <= 0 && t.floor <= 0)) continue;
            constexpr double kLeastCosine = 0.05;
            const double light =
                std::max(static_cast<double>(w.convolution[i]), t.floor * t.area * kLeastCosine);
            const double weight = light * visibility(w, t);
            if (height >= sine) {
                addPiece({t.corners, t.area, weight}, w);
                continue;
            }
            const ClippedTriangle clipped = clipToHemisphere(t.corners, n);
            double areas[2] = {0, 0};
            for (int k = 0; k < clipped.count; ++k)
                areas[k] = solidAngle(clipped.pieces[static_cast<std::size_t>(k)]);
            for (int k = 0; k < clipped.count; ++k)
                addPiece({clipped.pieces[static_cast<std::size_t>(k)], areas[k],
                          weight * areas[k] / (areas[0] + areas[1])},
                         w);
        }
    }

    static void addPiece(const Piece& piece, PaperWorkspace& w) {
        if (!(piece.weight > 0) || !(piece.area > 0)) return;
        w.pieces.push_back(piece);
        w.cdf.push_back((w.cdf.empty() ? 0.0 : w.cdf.back()) + piece.weight);
    }

    /// alpha A + (1 - alpha) / 2, or 1 without a cache. [paper 4.3]
    double visibility(const PaperWorkspace& w, const MapTriangle& t) const {
        if (!w.pooled) return 1;
        const CellVisibility v = visibilityOf(*w.pooled, t.level, t.cell);
        const double a = v.rays < static_cast<float>(context_.options.threshold)
                             ? 1.0
                             : static_cast<double>(v.ratio);
        return context_.options.alpha * a + (1 - context_.options.alpha) * 0.5;
    }
};

}  // namespace

std::unique_ptr<Estimator> makePaper(const EstimatorContext& context) {
    return std::make_unique<Paper>(context);
}

}  // namespace shadowcache
