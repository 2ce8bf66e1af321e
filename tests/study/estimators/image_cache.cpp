// The paper's estimator with the cache that the paper has: an item every few pixels, filled by the
// shadow rays of the pixels before. [paper 4.3]

#include <algorithm>
#include <unordered_map>

#include "common/cache/cache_items.h"
#include "tests/study/estimators/paper_variants.h"

namespace shadowcache::study {

namespace {

/// Side of the square of pixels that share an item.
constexpr int kItemPixels = 4;

/// Counts of one item, by group of triangles.
struct ImageItem {
    std::vector<std::uint8_t> n, d;
};

struct ImageWorkspace final : PaperWorkspace {
    std::unordered_map<std::uint64_t, ImageItem> cache;
    std::vector<float> visible, counted;  ///< sums over the items nearby, by group
    std::uint64_t item;                   ///< of the pixel in work
};

std::uint64_t itemKey(int column, int row) {
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(row)) << 32 |
           static_cast<std::uint32_t>(column);
}

/// The points of a workspace fill its cache in the order in which they are lit: a frame is rendered
/// by one thread.
class PaperImage final : public PaperVariant {
public:
    PaperImage(const EstimatorContext& context, const VariantOptions& options)
        : PaperVariant(context, options) {
        // Triangles stand in the order of the hierarchy: those of a common ancestor in a run.
        std::uint64_t last = 0;
        for (const MapTriangle& t : triangles()) {
            const int level = std::min(t.level, options.cacheLevel);
            const std::uint64_t cell = std::uint64_t{ancestorCell(t.cell, t.level, level)} * 16 +
                                       static_cast<std::uint64_t>(level);
            if (group_.empty() || cell != last) ++groups_;
            last = cell;
            group_.push_back(groups_ - 1);
        }
    }

    using Estimator::estimate;
    void estimate(const PointBatch& batch, Workspace& workspace,
                  std::span<Estimate> estimates) const override {
        PointBatch one = batch;
        for (std::size_t i = 0; i < batch.points.size(); ++i) {
            one.points = batch.points.subspan(i, 1);
            Paper::estimate(one, workspace, estimates.subspan(i, 1));
            if (workspace.samples.size() > 0) record(workspace);
        }
    }

    std::unique_ptr<Workspace> makeWorkspace() const override {
        return std::make_unique<ImageWorkspace>();
    }

private:
    std::vector<std::uint32_t> group_;  ///< by triangle: where it is counted
    std::uint32_t groups_ = 0;

    void lookUp(const ShadingPoint& point, PaperWorkspace& workspace) const override {
        auto& w = static_cast<ImageWorkspace&>(workspace);
        w.visible.assign(groups_, 0.0f);
        w.counted.assign(groups_, 0.0f);
        const int column = point.slot.filmX / kItemPixels, row = point.slot.filmY / kItemPixels;
        w.item = itemKey(column, row);
        for (int y = row - 1; y <= row + 1; ++y)
            for (int x = column - 1; x <= column + 1; ++x) {
                const auto found = w.cache.find(itemKey(x, y));
                if (found == w.cache.end()) continue;
                for (std::uint32_t g = 0; g < groups_; ++g) {
                    w.visible[g] += static_cast<float>(found->second.n[g]);
                    w.counted[g] += static_cast<float>(found->second.d[g]);
                }
            }
    }

    CachedVisibility cached(const PaperWorkspace& workspace,
                            std::uint32_t triangle) const override {
        const auto& w = static_cast<const ImageWorkspace&>(workspace);
        const std::uint32_t g = group_[triangle];
        if (!(w.counted[g] > 0)) return {};
        return {w.visible[g] / w.counted[g], w.counted[g]};
    }

    /// Counts what the point's rays found.
    void record(Workspace& workspace) const {
        auto& w = static_cast<ImageWorkspace&>(workspace);
        ImageItem& item = w.cache[w.item];
        item.n.resize(groups_);
        item.d.resize(groups_);
        for (std::size_t i = 0; i < w.triangleOf.size(); ++i) {
            if (w.samples.direction(i) == Vec3f(0, 0, 0)) continue;
            const std::uint32_t g = group_[w.triangleOf[i]];
            addCounts(item.n[g], item.d[g], w.samples.visible(i) ? 1 : 0, 1);
        }
    }
};

}  // namespace

std::unique_ptr<Estimator> makePaperImage(const EstimatorContext& context,
                                          const VariantOptions& options) {
    return std::make_unique<PaperImage>(context, options);
}

}  // namespace shadowcache::study
