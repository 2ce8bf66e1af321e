#include "render/sensors/sky_operator.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>
#include <vector>

#include "common/base/interrupt.h"
#include "common/base/parallel.h"
#include "common/base/progress.h"
#include "common/predict/cached_visibility.h"
#include "common/predict/exposure.h"
#include "render/sensors/air_irradiance.h"
#include "render/sensors/air_view.h"
#include "render/sensors/sky_patches.h"

namespace shadowcache {

namespace {

/// Items whose rows are in memory at a time: some MB.
constexpr std::size_t kTile = 256;

/// Bytes for the items' shares in the light of places that are handled together.
constexpr std::size_t kShareBytes = std::size_t{256} << 20;

/// As BounceSolve: bounces that are followed at most, and what ends them.
constexpr int kMostFollowed = 64;
constexpr double kLeastAdded = 1e-4;

/// Visibility of the patches times their cosines, by the counts of items.
class PatchRow {
public:
    PatchRow(const DirectionTiers& tiers, const PatchCosines& cosines, int level)
        : cosines_(cosines), level_(level), pooled_(tiers), row_(cellCount(level)) {}

    /// Of the items of a lookup, on a surface of a unit normal. Valid until the next call.
    std::span<float> of(std::span<const ItemView> items, const Vec3f& normal) {
        pooled_.pool(items);
        cosines_.at(level_, normal, row_);
        for (std::uint32_t patch = 0; patch < row_.size(); ++patch) {
            if (!(row_[patch] > 0)) continue;
            const CachedVisibility found = visibilityOf(pooled_, level_, patch);
            row_[patch] *= found.rays > 0 ? found.ratio : 0;
        }
        return row_;
    }

private:
    const PatchCosines& cosines_;
    const int level_;
    PooledVisibility pooled_;
    std::vector<float> row_;
};

/// Shares of the items' irradiance by the sky alone in what bounces add at one place.
using Shares = std::vector<Rgb>;

/// How a place's light comes from the items.
class SharesOfItems {
public:
    explicit SharesOfItems(const BouncePaths& paths)
        : paths_(paths), now_(paths.items.size()), next_(now_) {}

    /// Of a place among items.
    void of(std::span<const ItemView> around, Shares& out) {
        start(out);
        float weights = 0;
        for (const ItemView& item : around) weights += exposed(item);
        if (!(weights > 0)) return;
        for (const ItemView& item : around) next_[item.number] += Rgb(exposed(item) / weights);
        bounce();
        follow(out);
    }

    /// Of a place that sees items.
    void of(const AirView& view, Shares& out) {
        start(out);
        for (const AirView::Met& met : view.met)
            next_[met.item] +=
                paths_.looks[met.item].albedo * (met.share / static_cast<float>(kPi));
        follow(out);
    }

private:
    float exposed(const ItemView& item) const {
        return item.weight * paths_.items.exposure(static_cast<std::uint32_t>(item.number));
    }
    void start(Shares& out) {
        out.assign(paths_.items.size(), Rgb(0, 0, 0));
        std::ranges::fill(next_, Rgb(0, 0, 0));
    }
    /// One step back along the light: what `next_` has of items comes from those that they met.
    void bounce() {
        std::swap(now_, next_);
        std::ranges::fill(next_, Rgb(0, 0, 0));
        const auto rays = static_cast<std::size_t>(paths_.transport.raysPerItem);
        for (std::size_t i = 0; i < now_.size(); ++i) {
            if (now_[i] == Rgb(0, 0, 0)) continue;
            const auto met = std::span(paths_.transport.hit).subspan(i * rays, rays);
            const auto unknown = std::ranges::count(met, kNoItem);
            const float share =
                1 / static_cast<float>(std::max<std::ptrdiff_t>(1, std::ssize(met) - unknown));
            for (const std::uint32_t item : met)
                if (item < paths_.looks.size())
                    next_[item] += now_[i] * paths_.looks[item].albedo * share;
        }
    }
    /// Adds up what `next_` has, and all bounces before.
    void follow(Shares& out) {
        const int most =
            paths_.bounces < 0 ? kMostFollowed : std::min(paths_.bounces, kMostFollowed);
        double all = 0;
        for (int b = 1;; ++b) {
            double added = 0;
            for (std::size_t i = 0; i < out.size(); ++i) {
                out[i] += next_[i];
                added += static_cast<double>(next_[i].x + next_[i].y + next_[i].z);
            }
            all += added;
            if (b == most || (paths_.bounces < 0 && added <= kLeastAdded * all)) return;
            bounce();
        }
    }

    const BouncePaths& paths_;
    Shares now_, next_;
};

/// The operator's rows of a few places at a time.
class RowMaker {
public:
    RowMaker(const SkyOperator& wanted, const Places& places)
        : wanted_(wanted), places_(places), patches_(cellCount(wanted.level)) {}

    /// Places at a time.
    std::size_t most() const {
        if (!wanted_.bounces) return places_.size();
        const std::size_t bytes =
            std::max<std::size_t>(1, wanted_.bounces->items.size()) * sizeof(Rgb);
        return std::max<std::size_t>(1, kShareBytes / bytes);
    }

    /// Those of places `first` .. `first + out.size() / patches - 1`.
    void make(std::size_t first, std::span<Rgb> out) {
        const std::size_t count = out.size() / patches_;
        shares_.resize(wanted_.bounces ? count : 0);
        parallelFor(count, 1, [&](const Chunk& chunk) {
            throwIfInterrupted();
            start(first + chunk.begin, chunk.begin, out.subspan(chunk.begin * patches_, patches_));
        });
        if (wanted_.bounces) addBounces(out);
    }

private:
    /// The direct light of a place, and the items' shares in the rest.
    void start(std::size_t place, std::size_t k, std::span<Rgb> row) {
        if (wanted_.bounces) shares_[k].clear();
        if (!isPlace(places_, place)) {
            std::ranges::fill(row, Rgb(std::numeric_limits<float>::quiet_NaN()));
            return;
        }
        const Vec3d& position = places_.positions[place];
        const Vec3f normal(unitAlong(places_.normals[place]));
        ShadowCache::Reader reader(wanted_.cache);
        std::array<ItemView, ShadowCache::kMaxItems> found{};
        const auto items = std::span<const ItemView>(found).first(
            static_cast<std::size_t>(reader.lookUp(position, normal, found)));
        const double spacing = wanted_.cache.header().spacing;
        if (items.empty() && !wanted_.scene) refuseInAir(position);
        if (items.empty() ||
            (wanted_.scene && !isOnSurface(*wanted_.scene, spacing, position, normal))) {
            startInAir(position, normal, k, row);
            return;
        }
        float gain = 1;
        if (const BouncePaths* paths = wanted_.bounces) {
            gain = 1 / exposureOf(items, paths->items, leastExposureOf(paths->transport));
            SharesOfItems(*paths).of(items, shares_[k]);
        }
        PatchRow direct(wanted_.cache.header().tiers(), cosines_, wanted_.level);
        const std::span<const float> values = direct.of(items, normal);
        for (std::size_t patch = 0; patch < patches_; ++patch)
            row[patch] = Rgb(values[patch] * gain);
    }

    void startInAir(const Vec3d& position, const Vec3f& normal, std::size_t k, std::span<Rgb> row) {
        const BouncePaths* paths = wanted_.bounces;
        AirViewer viewer(*wanted_.scene, cosines_, paths ? &paths->items : nullptr);
        const AirView& view = viewer.look(position, normal);
        if (paths) SharesOfItems(*paths).of(view, shares_[k]);
        std::ranges::fill(row, Rgb(0, 0, 0));
        for (std::uint32_t cell = 0; cell < view.sky.size(); ++cell) {
            const std::uint32_t patch = ancestorCell(cell, Environment::kLevel, wanted_.level);
            row[patch] += Rgb(view.sky[cell] / cosines_.solidAngle(wanted_.level, patch));
        }
    }

    /// Adds what the items' direct light, a tile of them after the other, makes at each place.
    void addBounces(std::span<Rgb> out) {
        const std::size_t items = wanted_.bounces->items.size();
        std::vector<float> tile(kTile * patches_);
        Progress progress("sky operator", std::max<std::size_t>(1, items));
        for (std::size_t first = 0; first < items; first += kTile) {
            throwIfInterrupted();
            const std::size_t count = std::min(kTile, items - first);
            lightItems(first, count, tile);
            parallelFor(shares_.size(), 1, [&](const Chunk& chunk) {
                if (shares_[chunk.begin].empty()) return;
                addTile(std::span(shares_[chunk.begin]).subspan(first, count), tile,
                        out.subspan(chunk.begin * patches_, patches_));
            });
            progress.add(count);
        }
    }

    /// Irradiance of the items by each patch.
    void lightItems(std::size_t first, std::size_t count, std::span<float> tile) {
        const BouncePaths& paths = *wanted_.bounces;
        const float least = leastExposureOf(paths.transport);
        parallelFor(count, 16, [&](const Chunk& chunk) {
            ShadowCache::Reader reader(wanted_.cache);
            PatchRow row(wanted_.cache.header().tiers(), cosines_, wanted_.level);
            for (std::size_t k = chunk.begin; k < chunk.end; ++k) {
                const auto number = static_cast<std::uint32_t>(first + k);
                const auto out = tile.subspan(k * patches_, patches_);
                std::ranges::fill(out, 0.0f);
                if (!paths.items.isFound(number)) continue;
                const ItemView item = reader.item(number);
                const float gain = exposedGain(paths.items.exposure(number), least);
                std::ranges::transform(row.of({&item, 1}, paths.items.normal(number)), out.begin(),
                                       [&](float value) { return value * gain; });
            }
        });
    }

    void addTile(std::span<const Rgb> shares, std::span<const float> tile,
                 std::span<Rgb> row) const {
        std::vector<float> sum(3 * patches_, 0.0f);
        for (std::size_t k = 0; k < shares.size(); ++k) {
            if (shares[k] == Rgb(0, 0, 0)) continue;
            const float* light = tile.data() + k * patches_;
            for (std::size_t c = 0; c < 3; ++c) {
                float* to = sum.data() + c * patches_;
                const float share = shares[k][static_cast<int>(c)];
                for (std::size_t patch = 0; patch < patches_; ++patch)
                    to[patch] += share * light[patch];
            }
        }
        for (std::size_t patch = 0; patch < patches_; ++patch)
            row[patch] += Rgb(sum[patch], sum[patches_ + patch], sum[2 * patches_ + patch]);
    }

    const SkyOperator& wanted_;
    const Places& places_;
    const std::size_t patches_;
    const PatchCosines cosines_;
    std::vector<Shares> shares_;  ///< by place; empty for those that are none
};

}  // namespace

void SkyOperator::rows(const Places& places, std::span<Rgb> out) const {
    if (places.size() == 0) return;
    RowMaker maker(*this, places);
    const std::size_t patches = cellCount(level), most = maker.most();
    for (std::size_t first = 0; first < places.size(); first += most) {
        const std::size_t count = std::min(most, places.size() - first);
        maker.make(first, out.subspan(first * patches, count * patches));
    }
}

}  // namespace shadowcache
