#include "render/cached/surprise_exchange.h"

#include <algorithm>

namespace shadowcache {

SurpriseExchange::SurpriseExchange(const DirectionTiers& tiers) : baseLevel_(tiers.baseLevel()) {
    firstSlot_ = {0};
    for (int level = baseLevel_; level <= Environment::kLevel; level += 2)
        firstSlot_.push_back(firstSlot_.back() +
                             (cellCount(level) + kBlockCells - 1) / kBlockCells);
}

void SurpriseExchange::addPoint() {
    if (offers_.size() == size_) {
        offers_.emplace_back();
        offers_.back().slots.assign(firstSlot_.back(), -1);
    }
    Offers& offers = offers_[size_++];
    for (const std::uint16_t slot : offers.used) offers.slots[slot] = -1;
    offers.used.clear();
    offers.expected.clear();
}

void SurpriseExchange::offer(const RegionWeights& weights) {
    Offers& offers = offers_[lastPoint()];
    for (std::size_t g = 0; g < weights.size(); ++g) {
        const RegionGroup& group = weights.group(g);
        if (!group.anyShared) continue;
        const auto tier = static_cast<std::size_t>((group.level - baseLevel_) / 2);
        const std::uint32_t slot = firstSlot_[tier] + group.firstCell / kBlockCells;
        offers.slots[slot] = static_cast<std::int16_t>(offers.expected.size());
        offers.used.push_back(static_cast<std::uint16_t>(slot));
        Expected& expected = offers.expected.emplace_back();
        for (std::size_t i = 0; i < kBlockCells; ++i)
            expected[i] = weights.shared(g)[i] * weights.spread(g)[i];
    }
}

void SurpriseExchange::exchange(const Scene& scene, const Environment& environment,
                                std::span<const ShadingPoint> points,
                                std::span<Estimate> estimates) {
    for (const Surprise& surprise : surprises_) {
        findCandidates(surprise, environment, points);
        keepSurprised(surprise, scene, points, estimates);
        double density = 0;
        for (const Candidate& c : candidates_) density += c.density;
        for (const Candidate& c : candidates_) {
            const float cosine = surprise.direction.dot(points[c.point].normal);
            const Rgb found = surprise.radiance * static_cast<float>(static_cast<double>(cosine) /
                                                                     density * (c.open ? 1 : -1));
            Estimate& estimate = estimates[c.point];
            estimate.irradiance += found;
            const float luminance = environment.luminance(found);
            estimate.variance += luminance * luminance;
        }
    }
}

void SurpriseExchange::findCandidates(const Surprise& surprise, const Environment& environment,
                                      std::span<const ShadingPoint> points) {
    candidates_.clear();
    const std::size_t tiers = firstSlot_.size() - 1;
    std::array<std::uint32_t, 3> cell{};
    std::array<double, 3> density{};  // of one expected sample
    for (std::size_t t = 0; t < tiers; ++t) {
        const int level = baseLevel_ + 2 * static_cast<int>(t);
        cell[t] = ancestorCell(surprise.cell, Environment::kLevel, level);
        density[t] = surprise.lightDensity / environment.luminanceIntegral(level, cell[t]);
    }
    for (std::size_t p = 0; p < size_; ++p) {
        if (surprise.direction.dot(points[p].normal) <= 0) continue;
        const Offers& offers = offers_[p];
        for (std::size_t t = 0; t < tiers; ++t) {
            const std::int16_t slot = offers.slots[firstSlot_[t] + cell[t] / kBlockCells];
            if (slot < 0) continue;
            const auto expected = static_cast<double>(
                offers.expected[static_cast<std::size_t>(slot)][cell[t] % kBlockCells]);
            if (expected == 0) continue;
            candidates_.push_back({p, std::abs(expected) * density[t], expected > 0});
            break;
        }
    }
}

/// Removes the candidates that the direction does not surprise.
void SurpriseExchange::keepSurprised(const Surprise& surprise, const Scene& scene,
                                     std::span<const ShadingPoint> points,
                                     std::span<Estimate> estimates) {
    std::size_t kept = 0;
    RayPacket packet{};
    std::array<Candidate, RayPacket::kSize> queue;
    int queued = 0;
    const auto flush = [&] {
        const std::uint32_t open = scene.visibility(packet, queued);
        for (int i = 0; i < queued; ++i) {
            const Candidate& c = queue[static_cast<std::size_t>(i)];
            ++estimates[c.point].reused;
            if ((open >> i & 1u) == (c.open ? 1u : 0u)) candidates_[kept++] = c;
        }
        queued = 0;
    };
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
        const Candidate c = candidates_[i];
        if (c.point == surprise.finder) {
            candidates_[kept++] = c;
            continue;
        }
        packet.set(queued, points[c.point].rayOrigin, surprise.direction);
        queue[static_cast<std::size_t>(queued++)] = c;
        if (queued == RayPacket::kSize) flush();
    }
    if (queued > 0) flush();
    candidates_.resize(kept);
}

}  // namespace shadowcache
