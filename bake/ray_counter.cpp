#include "bake/ray_counter.h"

#include <algorithm>
#include <limits>

#include "common/parallel.h"
#include "common/sequence.h"

namespace shadowcache {

DirectionTable::DirectionTable() : centers_(cellCount(kLevel)) {
    parallelFor(centers_.size(), 4096, [&](const Chunk& chunk) {
        for (std::size_t i = chunk.begin; i < chunk.end; ++i)
            centers_[i] = Vec3f(cellCenter(kLevel, static_cast<std::uint32_t>(i)));
    });
}

RayCounter::RayCounter(const Scene& scene, const DirectionTable& directions, const Patch& patch,
                       std::uint64_t seed)
    : scene_(scene), directions_(directions), patch_(patch), state_(seed) {}

bool RayCounter::place(int level, std::uint32_t cell, int i, int count) {
    const std::uint64_t random = mixBits(state_ += 0x9e3779b97f4a7c15ull);
    const std::size_t origin = (random >> 32) % Patch::kOrigins;
    const Vec3f& direction =
        directions_.direction(level, cell, i, count, static_cast<std::uint32_t>(random));
    if (direction.dot(patch_.originNormal[origin]) <= 0) return false;
    packet_.set(queued_, patch_.origin[origin], direction);
    return true;
}

void RayCounter::add(int level, std::uint32_t cell, int count, Count& tally) {
    for (int i = 0; i < count; ++i) {
        if (!place(level, cell, i, count)) continue;
        tallies_[queued_++] = &tally;
        if (queued_ == RayPacket::kSize) flush();
    }
}

void RayCounter::flush() {
    if (queued_ == 0) return;
    const std::uint32_t open = scene_.visibility(packet_, queued_);
    for (int i = 0; i < queued_; ++i) {
        ++tallies_[i]->rays;
        tallies_[i]->open = static_cast<std::uint16_t>(tallies_[i]->open + ((open >> i) & 1));
    }
    traced_ += static_cast<std::uint64_t>(queued_);
    queued_ = 0;
}

float RayCounter::nearestOccluder(int level, std::uint32_t cell, Count& tally) {
    flush();
    for (int i = 0; i < RayPacket::kSize; ++i)
        if (place(level, cell, i, RayPacket::kSize)) ++queued_;
    float distance[RayPacket::kSize];
    scene_.distances(packet_, queued_, distance);
    float nearest = std::numeric_limits<float>::infinity();
    for (int i = 0; i < queued_; ++i) {
        ++tally.rays;
        if (distance[i] == std::numeric_limits<float>::infinity()) ++tally.open;
        nearest = std::min(nearest, distance[i]);
    }
    traced_ += static_cast<std::uint64_t>(queued_);
    queued_ = 0;
    return nearest;
}

}  // namespace shadowcache
