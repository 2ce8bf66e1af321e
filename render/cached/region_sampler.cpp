#include "render/cached/region_sampler.h"

#include <algorithm>
#include <cmath>

#include "common/base/sequence.h"

namespace shadowcache {

namespace {

/// Regions due this many samples or more get a whole number of strata of their own.
constexpr double kOwnStrata = 1.5;

constexpr double kBelowOne = 0x1.fffffffffffffp-1;

Region regionOf(const RegionWeights& weights, std::size_t g, int lane) {
    const RegionGroup& group = weights.group(g);
    return {group.level, group.firstCell + static_cast<std::uint32_t>(lane),
            weights.visibility(g)[lane], weights.shared(g)[lane]};
}

}  // namespace

void RegionSampler::draw(RegionWeights& weights, int samples, std::span<const std::uint32_t> words,
                         std::uint64_t seed) {
    words_ = words;
    hashBase_ = hashWords(seed, 80);
    used_ = 0;
    queued_.clear();
    queued_.reserve(static_cast<std::size_t>(samples) + 1);
    const double total = weights.spreadSum();
    const bool anyOwn = takeOwn(weights, total * kOwnStrata / samples);
    sumGroups(weights);
    const int rest =
        restSum_ > 0 ? std::max(1, static_cast<int>(std::ceil(restSum_ / total * samples))) : 0;
    const double perSpread = anyOwn ? (samples - rest) / ownSum_ : 0;
    if (perSpread * total * kOwnStrata / samples < 1) {
        // Too few samples for strata of one region: all regions share them.
        returnOwn();
        sumGroups(weights);
        drawRest(weights, samples);
    } else {
        drawOwn(perSpread);
        drawRest(weights, rest);
    }
    countSamples(weights);
    for (Queued& q : queued_) environment_.findTexel(q.draw);
}

RegionSampler::Drawn RegionSampler::drawn(std::size_t i) const {
    const Queued& q = queued_[i];
    return {q.region,
            environment_.finishDraw(q.draw, toUnitFloat(static_cast<std::uint32_t>(q.jitter)),
                                    toUnitFloat(static_cast<std::uint32_t>(q.jitter >> 32))),
            q.share, q.endsGroup};
}

bool RegionSampler::takeOwn(RegionWeights& weights, double least) {
    own_.clear();
    ownSum_ = 0;
    const auto threshold = static_cast<float>(least);
    for (std::size_t g = 0; g < weights.size(); ++g) {
        if (weights.group(g).spreadMax < threshold) continue;
        float* spread = weights.spread(g);
        for (int i = 0; i < kBlockCells; ++i) {
            if (spread[i] < threshold) continue;
            own_.push_back({regionOf(weights, g, i), static_cast<double>(spread[i]), &spread[i]});
            ownSum_ += own_.back().spread;
            spread[i] = 0;
        }
    }
    return !own_.empty();
}

void RegionSampler::returnOwn() {
    for (const Own& own : own_) *own.place = static_cast<float>(own.spread);
    own_.clear();
}

void RegionSampler::sumGroups(const RegionWeights& weights) {
    groupSum_.clear();
    restSum_ = 0;
    for (std::size_t g = 0; g < weights.size(); ++g) {
        double sum = 0;
        for (int i = 0; i < kBlockCells; ++i) sum += static_cast<double>(weights.spread(g)[i]);
        groupSum_.push_back(sum);
        restSum_ += sum;
    }
}

void RegionSampler::drawOwn(double perSpread) {
    double sum = 0;
    for (Own& own : own_) {
        const int before = static_cast<int>(sum + 1e-6);
        sum += own.spread * perSpread;
        own.count = static_cast<int>(sum + 1e-6) - before;
        for (int j = 0; j < own.count; ++j)
            queue(own.region, (j + nextNumber()) / own.count, 1.0 / own.count);
        endGroup();
    }
}

/// Draws `count` samples from the regions in the groups, evenly over all of them: a region's number
/// is its mean number rounded up or down.
void RegionSampler::drawRest(const RegionWeights& weights, int count) {
    perSpread_ = restSum_ > 0 ? count / restSum_ : 0;
    if (!(restSum_ > 0)) return;
    double below = 0;
    int j = 0;
    const double offset = nextNumber();
    double x = restSum_ * offset / count;
    std::size_t last = weights.size() - 1;
    while (!(groupSum_[last] > 0)) --last;
    for (std::size_t g = 0; g <= last && j < count; ++g) {
        if (x >= below + groupSum_[g] && g < last) {
            below += groupSum_[g];
            continue;
        }
        const float* spread = weights.spread(g);
        int lastLane = kBlockCells - 1;
        while (!(spread[lastLane] > 0)) --lastLane;
        for (int i = 0; i <= lastLane && j < count; ++i) {
            const auto s = static_cast<double>(spread[i]);
            // Rounding may leave the very last x past the end: it is the last region's.
            const bool end = g == last && i == lastLane;
            while (s > 0 && j < count && (x < below + s || end)) {
                queue(regionOf(weights, g, i), (x - below) / s, 1 / (s * perSpread_));
                nextHash();
                x = restSum_ * (++j + offset) / count;
            }
            below += s;
        }
    }
    endGroup();
}

/// Leaves in the weights how many samples each region has, or was to have on average.
void RegionSampler::countSamples(RegionWeights& weights) {
    for (std::size_t g = 0; g < weights.size(); ++g) {
        float* spread = weights.spread(g);
        for (int i = 0; i < kBlockCells; ++i)
            spread[i] = static_cast<float>(static_cast<double>(spread[i]) * perSpread_);
    }
    for (const Own& own : own_) *own.place = static_cast<float>(own.count);
}

void RegionSampler::queue(const Region& region, double place, double share) {
    Queued& q = queued_.emplace_back();
    q.region = region;
    q.share = share;
    q.draw = environment_.startDraw(region.level, region.cell, std::clamp(place, 0.0, kBelowOne));
    q.jitter = hash_;
    q.endsGroup = false;
}

void RegionSampler::endGroup() {
    if (!queued_.empty()) queued_.back().endsGroup = true;
}

void RegionSampler::nextHash() {
    hash_ = mixBits(hashBase_ + used_++ * 0x9e3779b97f4a7c15ull);
}

/// In [0, 1): 32 bits of the sequence and 16 of the sample's hash, which its jitter leaves.
double RegionSampler::nextNumber() {
    const std::size_t k = used_;
    nextHash();
    const std::uint64_t low = (hash_ & 0xff) << 8 | (hash_ >> 32 & 0xff);
    const std::uint64_t word = words_[std::min(k, words_.size() - 1)];
    return static_cast<double>(word << 16 | low) * 0x1p-48;
}

}  // namespace shadowcache
