#include "render/cached/cluster_sampler.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "common/random/salts.h"

namespace shadowcache {

std::span<const SampleCount> roundCounts(std::span<const double> wanted, double offset,
                                         std::vector<SampleCount>& buffer) {
    buffer.clear();
    double before = std::floor(offset), sum = offset;
    for (const double expected : wanted) {
        sum += expected;
        const double after = std::floor(sum);
        const auto drawn = static_cast<int>(after - std::exchange(before, after));
        buffer.push_back({drawn, expected < 1 ? expected : drawn, expected});
    }
    return buffer;
}

std::span<const ClusterSample> ClusterSampler::draw(const PointBatch& batch,
                                                    std::span<const std::uint32_t> members,
                                                    std::span<const SampleCount> counts,
                                                    const RegionDistribution& distribution,
                                                    Sequence sequence) {
    samples_.clear();
    if (distribution.empty()) return samples_;
    drawNumbers(batch, members, counts, sequence);
    if (numbers_.empty()) return samples_;
    sortNumbers();
    RegionDistribution::Walk walk(distribution);
    for (const Number& number : numbers_) {
        const RegionDistribution::Choice choice =
            walk.next(static_cast<double>(number.key) * 0x1p-64);
        samples_.push_back(
            {number.member, choice.place,
             static_cast<float>(choice.inverseChance / counts[number.member].divisor),
             distribution.startDraw(choice), number.jitter});
    }
    for (ClusterSample& sample : samples_) environment_.findGrain(sample.draw);
    for (ClusterSample& sample : samples_) environment_.findTexel(sample.draw);
    return samples_;
}

void ClusterSampler::drawNumbers(const PointBatch& batch, std::span<const std::uint32_t> members,
                                 std::span<const SampleCount> counts, Sequence sequence) {
    numbers_.clear();
    for (std::size_t i = 0; i < members.size(); ++i) {
        const BatchSlot& slot = batch.points[members[i]].slot;
        const int count = counts[i].drawn;
        const std::uint64_t base = hashWords(slot.seed, RenderSalt::clusterJitter, slot.cameraRay);
        for (int j = 0; j < count; ++j)
            numbers_.push_back(
                {0, static_cast<std::uint32_t>(i),
                 mixBits(base + static_cast<std::uint64_t>(j) * 0x9e3779b97f4a7c15ull)});
    }
    words_.resize(numbers_.size());
    const BatchSlot& first = batch.points[members.front()].slot;
    sequence.fill(0, 0, hashWords(first.seed, RenderSalt::clusterOrder, first.cameraRay), words_);
    for (std::size_t k = 0; k < numbers_.size(); ++k)
        numbers_[k].key = std::uint64_t{words_[k]} << 32 | mixBits(numbers_[k].jitter) >> 32;
}

/// By key. The first 2^b words of a (0, 1)-sequence fall into 2^b intervals, one into each, so
/// buckets leave next to nothing to sort.
void ClusterSampler::sortNumbers() {
    const int bits = static_cast<int>(std::bit_width(numbers_.size()));
    const int shift = 64 - bits;
    bucketEnd_.assign((std::size_t{1} << bits) + 1, 0);
    for (const Number& number : numbers_) ++bucketEnd_[(number.key >> shift) + 1];
    for (std::size_t b = 1; b < bucketEnd_.size(); ++b) bucketEnd_[b] += bucketEnd_[b - 1];
    sorted_.resize(numbers_.size());
    for (const Number& number : numbers_) sorted_[bucketEnd_[number.key >> shift]++] = number;
    for (std::size_t i = 1; i < sorted_.size(); ++i) {
        const Number number = sorted_[i];
        std::size_t j = i;
        for (; j > 0 && sorted_[j - 1].key > number.key; --j) sorted_[j] = sorted_[j - 1];
        sorted_[j] = number;
    }
    std::swap(numbers_, sorted_);
}

}  // namespace shadowcache
