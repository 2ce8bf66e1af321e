#include "render/bounces/exchange.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

#include "common/base/parallel.h"
#include "render/bounces/mirrored_sky.h"
#include "render/estimators/light_groups.h"

namespace shadowcache {

namespace {

/// Groups that a thread takes at a time.
constexpr std::size_t kGroupsOfChunk = 64;

/// Least density of a member's own ray: it drew the place, whatever rounding makes of the cosines.
constexpr float kLeastDensity = 1e-12f;

/// Densities of a group's members sum to a finite number.
constexpr float kMostDensity = std::numeric_limits<float>::max() / 1024;

/// From a density of directions to one of places, within what a float can hold.
float atPlace(float cosine, float squared, float cosineThere) {
    return std::min(cosine / squared * (cosineThere / squared), kMostDensity);
}

/// Vertices of a group as arrays, so that one loop does several at a time.
class GroupMembers {
public:
    void assign(const PathLevel& level, std::span<const std::uint32_t> members) {
        vertices_.clear();
        guides_.clear();
        for (std::vector<float>& values : values_) values.clear();
        for (const std::uint32_t member : members) {
            const PathVertex& v = level.at.vertices[member];
            vertices_.push_back(&v);
            guides_.push_back(&level.guides.of(member));
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const int a = static_cast<int>(axis);
                values_[axis].push_back(v.origin[a]);
                values_[3 + axis].push_back(v.normal[a]);
                values_[6 + axis].push_back(v.geometricNormal[a]);
            }
        }
    }

    std::size_t size() const { return vertices_.size(); }
    const PathVertex& operator[](std::size_t member) const { return *vertices_[member]; }
    const DirectionGuide& guideOf(std::size_t member) const { return *guides_[member]; }

    /// Densities, times pi and by place, with which the diffuse rays of each member meet the
    /// surface at another vertex if nothing lies between; 0 where it does not see its lit side.
    ///
    /// @param byCosine  receives those of rays drawn by the cosine
    /// @param density   and those of the member's own
    void meet(const PathVertex& to, std::span<float> byCosine, std::span<float> density) const {
        const auto *ox = values_[0].data(), *oy = values_[1].data(), *oz = values_[2].data();
        const auto *nx = values_[3].data(), *ny = values_[4].data(), *nz = values_[5].data();
        const auto *gx = values_[6].data(), *gy = values_[7].data(), *gz = values_[8].data();
        const float tx = to.target.x, ty = to.target.y, tz = to.target.z;
        const float hx = to.geometricNormal.x, hy = to.geometricNormal.y, hz = to.geometricNormal.z;
        for (std::size_t k = 0; k < byCosine.size(); ++k) {
            const float x = tx - ox[k], y = ty - oy[k], z = tz - oz[k];
            const float cosine = x * nx[k] + y * ny[k] + z * nz[k];
            const float facing = x * gx[k] + y * gy[k] + z * gz[k];
            const float cosineThere = -(x * hx + y * hy + z * hz);
            const float least = std::min(std::min(cosine, facing), cosineThere);
            const float squared =
                std::max(x * x + y * y + z * z, std::numeric_limits<float>::min());
            const float there = atPlace(cosine, squared, cosineThere);
            byCosine[k] = least > 0 ? there : 0.0f;
        }
        for (std::size_t k = 0; k < byCosine.size(); ++k)
            density[k] =
                guideOf(k).isCosine() || !(byCosine[k] > 0) ? byCosine[k] : guidedDensity(k, to);
    }

private:
    float guidedDensity(std::size_t member, const PathVertex& to) const {
        const PathVertex& from = *vertices_[member];
        const Vec3f way = to.target - from.origin;
        const float squared = std::max(way.length2(), std::numeric_limits<float>::min());
        const float length = std::sqrt(squared);
        const float density =
            guideOf(member).density(from.origin, way.dot(from.normal) / length, way / length);
        return atPlace(density * length, squared, -way.dot(to.geometricNormal));
    }

    std::vector<const PathVertex*> vertices_;
    std::vector<const DirectionGuide*> guides_;
    std::array<std::vector<float>, 9> values_;  ///< origins, normals, geometric normals, by axis
};

/// One group of vertices at a time.
class GroupExchange {
public:
    GroupExchange(const EstimatorContext& context, const PathLevel& level, const PathLevel& next,
                  std::vector<Rgb>& out, GroupedLight& grouped)
        : scene_(context.scene),
          level_(level),
          next_(next),
          out_(out),
          grouped_(grouped),
          sky_(context) {}

    /// @return rays so far
    std::uint64_t run(std::span<const std::uint32_t> members) {
        members_.assign(level_, members);
        findMeetings(members);
        const std::size_t n = members.size();
        sums_.assign(n, Rgb(0, 0, 0));
        mirrored_.assign(n, Rgb(0, 0, 0));
        for (std::size_t j = 0; j < n; ++j) {
            const std::int32_t child = childOf(members[j]);
            if (child == VertexChildren::kNone) continue;
            const auto byCosine = column(byCosine_, j), density = column(density_, j);
            float sum = 0;
            for (const float d : density) sum += d;
            const VertexLight& light = next_.light[static_cast<std::size_t>(child)];
            const Rgb radiance = diffuseRadiance(vertexMet(child), light) * static_cast<float>(kPi);
            findGroups(child);
            for (std::size_t k = 0; k < n; ++k) {
                if (!(byCosine[k] > 0)) continue;
                const Rgb tint = tintOf(k, vertexMet(child), k == j);
                const float weight = byCosine[k] / sum;
                sums_[k] += radiance * tint * weight;
                if (!ofGroups_.empty()) addTo(grouped_[members[k]], ofGroups_, tint * weight);
                if (vertexMet(child).sharesMirroredSky)
                    sky_.add(vertexMet(child), next_.at.lobeOf(vertexMet(child)),
                             members_[k].origin, static_cast<std::uint32_t>(k),
                             tint * (weight * static_cast<float>(kPi)), mirrored_);
            }
            const Rgb share =
                vertexMet(child).tint * (static_cast<float>(kPi) * (byCosine[j] / density[j]));
            sums_[j] += light.mirrored * share;
            if (!next_.groupedLight.mirrored.empty())
                addTo(grouped_[members[j]],
                      next_.groupedLight.mirrored[static_cast<std::size_t>(child)], share);
        }
        sky_.finish(mirrored_);
        for (std::size_t k = 0; k < n; ++k) {
            out_[members[k]] = sums_[k] + mirrored_[k];
            if (!grouped_.empty()) grouped_[members[k]][LightGroups::kSky] += mirrored_[k];
        }
        return rays_ + sky_.rays();
    }

private:
    /// Of the rays of all members with what member j's ray met.
    std::span<float> column(std::vector<float>& values, std::size_t j) const {
        return std::span(values).subspan(j * members_.size(), members_.size());
    }
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
    Rgb tintOf(std::size_t member, const PathVertex& met, bool itself) const {
        if (itself) return met.tint;
        if (!scene_.tints()) return {1, 1, 1};
        const Vec3f& origin = members_[member].origin;
        return scene_.tint(origin, wayBetween(origin, met.target, met.geometricNormal), 1);
    }

    void findMeetings(std::span<const std::uint32_t> members) {
        const std::size_t n = members.size();
        byCosine_.assign(n * n, 0);
        density_.assign(n * n, 0);
        for (std::size_t j = 0; j < n; ++j) {
            const std::int32_t child = childOf(members[j]);
            if (child == VertexChildren::kNone) continue;
            const PathVertex& met = vertexMet(child);
            const auto byCosine = column(byCosine_, j), density = column(density_, j);
            members_.meet(met, byCosine, density);
            meetOwn(j, level_.children[members[j]]);
            for (std::size_t k = 0; k < n; ++k)
                if (k != j && density[k] > 0) {
                    const Vec3f& origin = members_[k].origin;
                    enqueue(origin, wayBetween(origin, met.target, met.geometricNormal), j * n + k);
                }
        }
        flush();
    }

    /// A member with what its own ray met: that drew it, whatever rounding makes of its direction.
    void meetOwn(std::size_t j, const VertexChildren& children) {
        float& byCosine = column(byCosine_, j)[j];
        byCosine = std::max(byCosine, kLeastDensity);
        float ratio = 1;
        if (!members_.guideOf(j).isCosine()) {
            ratio = children.density / children.cosine;
            byCosine = std::min(byCosine, kMostDensity / std::max(1.0f, ratio));
        }
        column(density_, j)[j] = byCosine * ratio;
    }

    /// @param meeting  number that it tests
    void enqueue(const Vec3f& origin, const Vec3f& way, std::size_t meeting) {
        for (int k = 0; k < 3; ++k) {
            stream_.origin[k][queued_] = origin[k];
            stream_.direction[k][queued_] = way[k];
        }
        stream_.reach[queued_] = 1;
        asked_[queued_] = meeting;
        if (++queued_ == RayStream::kSize) flush();
    }

    void flush() {
        if (queued_ == 0) return;
        scene_.trace(stream_, queued_);
        for (std::size_t i = 0; i < queued_; ++i)
            if (stream_.reach[i] < 0) byCosine_[asked_[i]] = density_[asked_[i]] = 0;
        rays_ += queued_;
        queued_ = 0;
    }

    const Scene& scene_;
    const PathLevel& level_;
    const PathLevel& next_;
    std::vector<Rgb>& out_;
    GroupedLight& grouped_;
    std::vector<Rgb> ofGroups_;
    GroupMembers members_;
    std::vector<Rgb> sums_;      ///< that members receive
    std::vector<Rgb> mirrored_;  ///< and what they see mirrored of the sky
    MirroredSky sky_;
    std::vector<float> byCosine_, density_;  ///< GroupMembers::meet(), column by column
    RayStream stream_{};
    std::size_t asked_[RayStream::kSize] = {};  ///< numbers of what the rays test
    std::size_t queued_ = 0;
    std::uint64_t rays_ = 0;
};

}  // namespace

std::vector<Rgb> exchange(const EstimatorContext& context, const PathLevel& level,
                          const PathLevel& next, std::uint64_t& rays, GroupedLight& grouped) {
    const VertexGroups& groups = level.groups;
    std::vector<Rgb> out(level.size(), Rgb(0.0f));
    std::vector<std::uint64_t> counts((groups.count() + kGroupsOfChunk - 1) / kGroupsOfChunk);
    parallelFor(groups.count(), kGroupsOfChunk, [&](const Chunk& chunk) {
        GroupExchange exchange(context, level, next, out, grouped);
        for (std::size_t g = chunk.begin; g < chunk.end; ++g)
            counts[chunk.index] = exchange.run(groups.group(g));
    });
    rays = std::accumulate(counts.begin(), counts.end(), rays);
    return out;
}

}  // namespace shadowcache
