#include "render/regions/region_distribution.h"

#include <algorithm>
#include <cassert>

namespace shadowcache {

namespace {

constexpr double kBelowOne = 0x1.fffffffffffffp-1;

}  // namespace

RegionDistribution::RegionDistribution(const Environment& environment)
    : environment_(&environment) {
    for (std::size_t level = 0; level <= Environment::kLevel; ++level)
        firstSlot_[level + 1] =
            firstSlot_[level] + cellCount(static_cast<int>(level)) / kBlockCells + 1;
    slots_.assign(firstSlot_.back(), -1);
}

const RegionDistribution& RegionDistribution::assign(const Regions& regions,
                                                     const RegionShares& shares) {
    for (const Group& group : groups_) slots_[slotOf(group.level, group.firstCell)] = -1;
    groups_.resize(regions.groups.size());
    weightSum_ = shares.weightSum;
    coarsest_ = Environment::kLevel;
    finest_ = -1;
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        const RegionGroup& region = regions.groups[g];
        Group& group = groups_[g];
        std::copy_n(shares.groups[g].weight, kBlockCells, group.weight);
        group.weightSum = shares.groups[g].weightSum;
        group.firstCell = region.firstCell;
        group.level = region.level;
        slots_[slotOf(group.level, group.firstCell)] = static_cast<std::int16_t>(g);
        coarsest_ = std::min(coarsest_, group.level);
        finest_ = std::max(finest_, group.level);
    }
    return *this;
}

EnvironmentSample RegionDistribution::sample(double u, float jitterX, float jitterY) const {
    const Choice choice = Walk(*this).next(u);
    Environment::Draw draw = startDraw(choice);
    environment_->findGrain(draw);
    environment_->findTexel(draw);
    EnvironmentSample s = environment_->finishDraw(draw, jitterX, jitterY);
    s.density = static_cast<float>(static_cast<double>(s.density) / choice.inverseChance);
    return s;
}

double RegionDistribution::pdf(const Vec3f& direction) const {
    const EnvironmentSample s = environment_->lookUp(direction);
    return pdf(find(s.cell), static_cast<double>(s.density) * environment_->luminanceIntegral());
}

double RegionDistribution::pdf(const RegionPlace& place, double lightDensity) const {
    if (!place.found()) return 0;
    return chance(place) * lightDensity / light(place);
}

RegionPlace RegionDistribution::find(std::uint32_t cell) const {
    for (int level = coarsest_; level <= finest_; level += 2) {  // as a cache's tiers
        const std::uint32_t ancestor = ancestorCell(cell, Environment::kLevel, level);
        const std::int16_t group = slots_[slotOf(level, ancestor)];
        if (group < 0) continue;
        const RegionPlace place{static_cast<std::uint32_t>(group),
                                static_cast<int>(ancestor % kBlockCells)};
        if (groupAt(place).weight[place.lane] > 0) return place;
    }
    return {};
}

Environment::Draw RegionDistribution::startDraw(const Choice& choice) const {
    const Group& group = groupAt(choice.place);
    return environment_->startDraw(
        group.level, group.firstCell + static_cast<std::uint32_t>(choice.place.lane), choice.u);
}

RegionDistribution::Walk::Walk(const RegionDistribution& distribution)
    : distribution_(distribution), lastGroup_(distribution.groups_.size() - 1) {
    assert(!distribution.empty());
    while (!(distribution.groups_[lastGroup_].weightSum > 0)) --lastGroup_;
}

RegionDistribution::Choice RegionDistribution::Walk::next(double u) {
    const std::vector<Group>& groups = distribution_.groups_;
    const double x = u * distribution_.weightSum_;
    while (group_ < lastGroup_ && x >= belowGroup_ + groups[group_].weightSum) {
        belowGroup_ += groups[group_++].weightSum;
        belowLane_ = belowGroup_;
        lane_ = 0;
    }
    const Group& group = groups[group_];
    int lastLane = kBlockCells - 1;
    while (lastLane > 0 && !(group.weight[lastLane] > 0)) --lastLane;
    while (lane_ < lastLane && x >= belowLane_ + static_cast<double>(group.weight[lane_]))
        belowLane_ += static_cast<double>(group.weight[lane_++]);
    const auto weight = static_cast<double>(group.weight[lane_]);
    return {{static_cast<std::uint32_t>(group_), lane_},
            distribution_.weightSum_ / weight,
            std::clamp((x - belowLane_) / weight, 0.0, kBelowOne)};
}

}  // namespace shadowcache
