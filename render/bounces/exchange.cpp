#include "render/bounces/exchange.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

#include "common/base/parallel.h"

namespace shadowcache {

namespace {

/// Groups that a thread takes at a time.
constexpr std::size_t kGroupsOfChunk = 64;

/// Least density of a member's own ray: it drew the place, whatever rounding makes of the cosines.
constexpr float kLeastDensity = 1e-12f;

/// Densities of a group's members sum to a finite number.
constexpr float kMostDensity = std::numeric_limits<float>::max() / 1024;

/// How the diffuse rays of one vertex meet the surface at another one, if nothing lies between; 0
/// where it does not see its lit side.
struct Meeting {
    float byCosine = 0;  ///< density of rays drawn by the cosine, times pi
    float density = 0;   ///< that of its own
};

/// From a density of directions to one of places, within what a float can hold.
float atPlace(float cosine, float squared, float cosineThere) {
    return std::min(cosine / squared * (cosineThere / squared), kMostDensity);
}

Meeting meetingOf(const PathVertex& from, const DirectionGuide& guide, const PathVertex& to) {
    const Vec3f way = to.target - from.origin;
    const float cosine = way.dot(from.normal), cosineThere = -way.dot(to.geometricNormal);
    if (cosine <= 0 || cosineThere <= 0 || way.dot(from.geometricNormal) <= 0) return {};
    const float squared = std::max(way.length2(), std::numeric_limits<float>::min());
    const float byCosine = atPlace(cosine, squared, cosineThere);
    if (guide.isCosine()) return {byCosine, byCosine};
    const float length = std::sqrt(squared);
    const float density = guide.density(from.origin, cosine / length, way / length);
    return {byCosine, atPlace(density * length, squared, cosineThere)};
}

/// One group of vertices at a time.
class GroupExchange {
public:
    GroupExchange(const Scene& scene, const PathLevel& level, const PathLevel& next,
                  std::vector<Rgb>& out, GroupedLight& grouped)
        : scene_(scene), level_(level), next_(next), out_(out), grouped_(grouped) {}

    std::uint64_t run(std::span<const std::uint32_t> members) {
        findMeetings(members);
        const std::size_t n = members.size();
        for (std::size_t j = 0; j < n; ++j) {
            const std::int32_t child = childOf(members[j]);
            if (child == VertexChildren::kNone) continue;
            const auto column = std::span(meetings_).subspan(j * n, n);
            float sum = 0;
            for (const Meeting& meeting : column) sum += meeting.density;
            const VertexLight& light = next_.light[static_cast<std::size_t>(child)];
            const Rgb radiance = diffuseRadiance(vertexMet(child), light) * static_cast<float>(kPi);
            findGroups(child);
            for (std::size_t k = 0; k < n; ++k) {
                if (!(column[k].byCosine > 0)) continue;
                const Rgb tint = tintOf(members[k], vertexMet(child), k == j);
                const float weight = column[k].byCosine / sum;
                out_[members[k]] += radiance * tint * weight;
                if (!ofGroups_.empty()) addTo(grouped_[members[k]], ofGroups_, tint * weight);
            }
            const Rgb share = vertexMet(child).tint *
                              (static_cast<float>(kPi) * (column[j].byCosine / column[j].density));
            out_[members[j]] += light.mirrored * share;
            if (!next_.groupedLight.mirrored.empty())
                addTo(grouped_[members[j]],
                      next_.groupedLight.mirrored[static_cast<std::size_t>(child)], share);
        }
        return rays_;
    }

private:
    std::int32_t childOf(std::uint32_t member) const { return level_.children[member].diffuse; }
    const PathVertex& vertexMet(std::int32_t child) const {
        return next_.at.vertices[static_cast<std::size_t>(child)];
    }

    /// Sets what a vertex sends to all sides, times pi, by group.
    void findGroups(std::int32_t child) {
        if (grouped_.empty()) return;
        const auto irradiance = next_.groupedLight.irradiance[static_cast<std::size_t>(child)];
        ofGroups_.resize(irradiance.size());
        for (std::size_t g = 0; g < irradiance.size(); ++g)
            ofGroups_[g] =
                diffuseRadiance(vertexMet(child), g, irradiance[g]) * static_cast<float>(kPi);
    }

    /// By panes between a member and what it met itself, or another.
    Rgb tintOf(std::uint32_t member, const PathVertex& met, bool itself) const {
        if (itself) return met.tint;
        if (!scene_.tints()) return {1, 1, 1};
        const Vec3f& origin = level_.at.vertices[member].origin;
        return scene_.tint(origin, wayBetween(origin, met.target, met.geometricNormal), 1);
    }

    /// meetings_[j n + k]: that of member k's rays with what j's ray met.
    void findMeetings(std::span<const std::uint32_t> members) {
        const std::size_t n = members.size();
        meetings_.assign(n * n, {});
        rays_ = 0;
        for (std::size_t j = 0; j < n; ++j) {
            const std::int32_t child = childOf(members[j]);
            if (child == VertexChildren::kNone) continue;
            const PathVertex& met = vertexMet(child);
            for (std::size_t k = 0; k < n; ++k) {
                const PathVertex& from = level_.at.vertices[members[k]];
                const DirectionGuide& guide = level_.guides.of(members[k]);
                Meeting& meeting = meetings_[j * n + k];
                meeting = meetingOf(from, guide, met);
                if (k == j)
                    meeting = ownMeeting(meeting, guide, level_.children[members[j]]);
                else if (meeting.density > 0)
                    enqueue(from.origin, wayBetween(from.origin, met.target, met.geometricNormal),
                            meeting);
            }
        }
        flush();
    }

    /// Of a member with what its own ray met: that drew it, whatever rounding makes of its
    /// direction.
    static Meeting ownMeeting(Meeting found, const DirectionGuide& guide,
                              const VertexChildren& children) {
        found.byCosine = std::max(found.byCosine, kLeastDensity);
        if (guide.isCosine()) return {found.byCosine, found.byCosine};
        const float ratio = children.density / children.cosine;
        found.byCosine = std::min(found.byCosine, kMostDensity / std::max(1.0f, ratio));
        return {found.byCosine, found.byCosine * ratio};
    }

    void enqueue(const Vec3f& origin, const Vec3f& way, Meeting& meeting) {
        for (int k = 0; k < 3; ++k) {
            stream_.origin[k][queued_] = origin[k];
            stream_.direction[k][queued_] = way[k];
        }
        stream_.reach[queued_] = 1;
        asked_[queued_] = &meeting;
        if (++queued_ == RayStream::kSize) flush();
    }

    void flush() {
        if (queued_ == 0) return;
        scene_.trace(stream_, queued_);
        // Streams do not see what moves.
        const bool moves = !scene_.movingBalls().empty();
        for (std::size_t i = 0; i < queued_; ++i) {
            const auto vector = [i](const float(&of)[3][RayStream::kSize]) {
                return Vec3f(of[0][i], of[1][i], of[2][i]);
            };
            if (stream_.reach[i] < 0 ||
                (moves && !scene_.isFree(vector(stream_.origin), vector(stream_.direction))))
                *asked_[i] = {};
        }
        rays_ += queued_;
        queued_ = 0;
    }

    const Scene& scene_;
    const PathLevel& level_;
    const PathLevel& next_;
    std::vector<Rgb>& out_;
    GroupedLight& grouped_;
    std::vector<Rgb> ofGroups_;
    std::vector<Meeting> meetings_;
    RayStream stream_{};
    Meeting* asked_[RayStream::kSize] = {};
    std::size_t queued_ = 0;
    std::uint64_t rays_ = 0;
};

}  // namespace

std::vector<Rgb> exchange(const Scene& scene, const PathLevel& level, const PathLevel& next,
                          std::uint64_t& rays, GroupedLight& grouped) {
    const VertexGroups& groups = level.groups;
    std::vector<Rgb> out(level.size(), Rgb(0.0f));
    std::vector<std::uint64_t> counts((groups.count() + kGroupsOfChunk - 1) / kGroupsOfChunk);
    parallelFor(groups.count(), kGroupsOfChunk, [&](const Chunk& chunk) {
        GroupExchange exchange(scene, level, next, out, grouped);
        for (std::size_t g = chunk.begin; g < chunk.end; ++g)
            counts[chunk.index] += exchange.run(groups.group(g));
    });
    rays = std::accumulate(counts.begin(), counts.end(), rays);
    return out;
}

}  // namespace shadowcache
