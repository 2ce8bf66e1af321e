#include "common/predict/bounce_solve.h"

#include <algorithm>
#include <utility>

#include "common/base/interrupt.h"
#include "common/base/parallel.h"
#include "common/base/progress.h"
#include "common/predict/cache_preview.h"
#include "common/predict/exposure.h"

namespace shadowcache {

namespace {

/// Items that a thread takes at a time.
constexpr std::size_t kSolveChunk = 1024;

/// Bounces that are solved for, at most: what later ones add is left to the residual.
constexpr int kMostSolved = 64;

/// Part of the irradiance, in the mean, that ends a solve without a number of bounces.
constexpr double kLeastAdded = 1e-4;

/// Direct irradiance of all items, by their own counts at their own normals: of the exposed part of
/// their surface, since the hidden part has none. What is less exposed than `leastExposure` counts
/// as hidden.
///
/// @param ofEmitters  may be empty
std::vector<Rgb> directOf(const ShadowCache& cache, const ItemTable& items,
                          const Environment& environment, std::span<const Rgb> ofEmitters,
                          float leastExposure) {
    const CachePreview preview(environment, cache.header().tiers());
    std::vector<Rgb> direct(items.size(), Rgb(0, 0, 0));
    Progress progress("predict light", std::max<std::size_t>(1, items.size()));
    parallelFor(items.size(), kSolveChunk, [&](const Chunk& chunk) {
        throwIfInterrupted();
        ShadowCache::Reader reader(cache);
        for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
            const auto number = static_cast<std::uint32_t>(i);
            if (!items.isFound(number)) continue;
            direct[i] = preview.irradiance(reader.item(i), items.normal(number));
            if (!ofEmitters.empty()) direct[i] += ofEmitters[i];
            direct[i] *= exposedGain(items.exposure(number), leastExposure);
        }
        progress.add(chunk.end - chunk.begin);
    });
    return direct;
}

/// What the rays of items met of emitters: noisy, and of few of them.
///
/// @param emitted  (item) is the radiance of an item
template <class Emitted>
void addMetEmission(const Transport& transport, const Emitted& emitted, std::vector<Rgb>& direct) {
    const auto rays = static_cast<std::size_t>(transport.raysPerItem);
    for (std::size_t i = 0; i < direct.size(); ++i) {
        Rgb sum(0, 0, 0);
        int known = 0;
        for (std::size_t k = i * rays; k < (i + 1) * rays; ++k) {
            known += transport.hit[k] != kNoItem ? 1 : 0;
            if (transport.hit[k] < direct.size()) sum += emitted(transport.hit[k]);
        }
        direct[i] += sum * (static_cast<float>(kPi) / static_cast<float>(std::max(1, known)));
    }
}

}  // namespace

BounceSolve::BounceSolve(const ShadowCache& cache, const ItemTable& items,
                         const Transport& transport, const Environment& environment,
                         std::span<const ItemLook> looks, int bounces,
                         std::span<const Rgb> ofEmitters)
    : items_(items),
      leastExposure_(leastExposureOf(transport)),
      keepsAll_(bounces >= 0),
      countsEmitters_(!ofEmitters.empty()) {
    irradiance_.push_back(directOf(cache, items, environment, ofEmitters, leastExposure_));
    const bool emits = std::ranges::any_of(
        looks, [](const ItemLook& look) { return look.emission != Rgb(0, 0, 0); });
    if (emits && !countsEmitters_)
        addMetEmission(
            transport, [&](std::uint32_t item) { return looks[item].emission; },
            irradiance_.front());
    const int most = bounces < 0 ? kMostSolved : std::min(bounces, kMostSolved);
    while (solved_ < most) {
        const double added = addBounce(transport, looks);
        if (!keepsAll_ && added <= kLeastAdded * sumOfLast()) break;
    }
}

BounceSolve::BounceSolve(const BounceSolve& whole, std::vector<Rgb> direct)
    : items_(whole.items_),
      leastExposure_(whole.leastExposure_),
      keepsAll_(whole.keepsAll_),
      countsEmitters_(whole.countsEmitters_) {
    irradiance_.push_back(std::move(direct));
}

BounceSolve BounceSolve::ofPart(const Transport& transport, std::span<const ItemLook> looks,
                                std::span<const Rgb> light) const {
    std::vector<Rgb> direct(items_.size(), Rgb(0, 0, 0));
    if (!countsEmitters_)
        addMetEmission(
            transport, [&](std::uint32_t item) { return light[item]; }, direct);
    for (std::uint32_t i = 0; countsEmitters_ && i < items_.size(); ++i)
        if (items_.isFound(i))
            direct[i] = light[i] * exposedGain(items_.exposure(i), leastExposure_);
    BounceSolve part(*this, std::move(direct));
    while (part.solved_ < solved_) part.addBounce(transport, looks);
    return part;
}

double BounceSolve::addBounce(const Transport& transport, std::span<const ItemLook> looks) {
    throwIfInterrupted();
    const auto rays = static_cast<std::size_t>(transport.raysPerItem);
    const std::vector<Rgb>&before = irradiance_.back(), &direct = irradiance_.front();
    std::vector<Rgb> next(items_.size());
    const double added = parallelSum(items_.size(), kSolveChunk, [&](const Chunk& chunk) {
        double change = 0;
        for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
            Rgb sum(0, 0, 0);
            int known = 0;
            for (std::size_t k = i * rays; k < (i + 1) * rays; ++k) {
                const std::uint32_t met = transport.hit[k];
                known += met != kNoItem ? 1 : 0;
                if (met >= looks.size()) continue;
                sum += looks[met].albedo * before[met];
            }
            next[i] = direct[i] + sum * (1 / static_cast<float>(std::max(1, known)));
            for (int c = 0; c < 3; ++c)
                change += std::abs(static_cast<double>(next[i][c] - before[i][c]));
        }
        return change;
    });
    irradiance_.push_back(std::move(next));
    ++solved_;
    // Only the first and the last are read then.
    if (!keepsAll_ && solved_ > 1) irradiance_.erase(irradiance_.end() - 2);
    return added;
}

double BounceSolve::sumOfLast() const {
    return parallelSum(items_.size(), kSolveChunk, [&](const Chunk& chunk) {
        double sum = 0;
        for (std::size_t i = chunk.begin; i < chunk.end; ++i)
            for (int c = 0; c < 3; ++c) sum += static_cast<double>(irradiance_.back()[i][c]);
        return sum;
    });
}

Rgb BounceSolve::indirect(std::span<const ItemView> items, int bounces) const {
    Rgb sum(0, 0, 0);
    float weights = 0;
    for (const ItemView& item : items) {
        const auto number = static_cast<std::uint32_t>(item.number);
        const float weight = item.weight * items_.exposure(number);
        sum += indirect(number, bounces) * weight;
        weights += weight;
    }
    return weights > 0 ? sum * (1 / weights) : sum;
}

float BounceSolve::exposure(std::span<const ItemView> items) const {
    return exposureOf(items, items_, leastExposure_);
}

}  // namespace shadowcache
