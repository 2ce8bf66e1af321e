#include "render/bounces/vertex_light.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "common/base/parallel.h"
#include "common/base/tuned.h"
#include "common/random/salts.h"

namespace shadowcache {

namespace {

/// Chance that a vertex's direct light is estimated where it is predicted.
SHADOWCACHE_TUNED(float, kDirectChance, 0.5f);

/// Chance that a vertex sends a diffuse ray where its irradiance is predicted.
SHADOWCACHE_TUNED(float, kBounceChance, 0.6f);

/// Least and, of paths without end, highest chance by Russian roulette.
constexpr float kLeastChance = 0.05f, kMostChance = 0.95f;

/// Vertices that are lit together.
SHADOWCACHE_TUNED(std::size_t, kBatchVertices, 4096);

float highest(const Rgb& color) {
    return std::max({color.x, color.y, color.z});
}

float roulette(float reflectance, bool unlimited) {
    return std::clamp(reflectance, kLeastChance, unlimited ? kMostChance : 1.0f);
}

/// One batch of vertices that are lit together.
class LitBatch {
public:
    LitBatch(const Estimator& estimator, const EstimatorPlan* plan, PathLevel& level)
        : estimator_(estimator), plan_(plan), level_(level) {}

    void add(std::uint32_t number) {
        const PathVertex& v = level_.vertices[number];
        const EstimatorContext& context = estimator_.context();
        const SetPlace place{v.origin, context.scene.mesh().origin + Vec3d(v.target), v.normal,
                             v.geometricNormal};
        BatchSlot slot{.seed = hashWords(v.seed, RenderSalt::bounceDirect),
                       .pixel = static_cast<std::uint32_t>(points_.size())};
        const float counts = context.environment.luminance(v.albedo) * v.weight;
        if (v.errorScale > 0)
            slot.errorScale = std::min(
                static_cast<float>(kPi) * v.errorScale * v.directChance / std::max(counts, 1e-6f),
                std::numeric_limits<float>::max());
        numbers_.push_back(number);
        points_.push_back({place, slot});
    }

    /// @return shadow rays
    std::uint64_t light(Workspace& workspace) {
        const PointBatch batch{
            .points = points_, .pixels = static_cast<std::uint32_t>(points_.size()), .plan = plan_};
        std::vector<Estimate> estimates(points_.size());
        estimator_.estimate(batch, workspace, estimates);
        std::uint64_t rays = 0;
        for (std::size_t i = 0; i < points_.size(); ++i) {
            PathVertex& v = level_.vertices[numbers_[i]];
            const Rgb known = v.item == kNoItem ? Rgb(0, 0, 0)
                                                : estimator_.context().solve->irradiance(v.item, 0);
            v.irradiance += (estimates[i].irradiance - known) * (1 / v.directChance);
            rays += estimates[i].rays + estimates[i].reused;
        }
        return rays + lightLobes(batch, workspace);
    }

private:
    std::uint64_t lightLobes(const PointBatch& batch, Workspace& workspace) {
        std::vector<GlossyPoint> glossy;
        std::vector<std::uint32_t> of;
        for (std::size_t i = 0; i < points_.size(); ++i) {
            const PathVertex& v = level_.vertices[numbers_[i]];
            if (v.lobe < 0) continue;
            glossy.push_back({points_[i], level_.lobes[static_cast<std::size_t>(v.lobe)]});
            of.push_back(numbers_[i]);
        }
        if (glossy.empty()) return 0;
        std::vector<GlossEstimate> estimates(glossy.size());
        estimator_.estimateGloss(batch, glossy, workspace, estimates);
        std::uint64_t rays = 0;
        for (std::size_t i = 0; i < glossy.size(); ++i) {
            PathVertex& v = level_.vertices[of[i]];
            v.mirrored += estimates[i].radiance * (1 / v.directChance);
            rays += estimates[i].rays;
        }
        return rays;
    }

    const Estimator& estimator_;
    const EstimatorPlan* plan_;
    PathLevel& level_;
    std::vector<std::uint32_t> numbers_;
    std::vector<ShadingPoint> points_;
};

}  // namespace

float chanceOf(const PathVertex& vertex, std::uint64_t choice) {
    return static_cast<float>(toUnit(hashWords(vertex.seed, RenderSalt::bounceSends, choice)));
}

LobeRay lobeRayOf(const PathVertex& vertex, const GlossyLobe& lobe) {
    const auto number = [&](std::uint64_t dimension) {
        // Rounding must not reach 1.
        return static_cast<float>(
                   toUnit(hashWords(vertex.seed, RenderSalt::bounceLobe, dimension))) *
               0x1.fffffep-1f;
    };
    LobeRay ray;
    ray.direction = lobe.sample(number(0), number(1));
    const float density = lobe.density(ray.direction);
    if (density > 0 && ray.direction.dot(vertex.geometricNormal) > 0)
        ray.share = lobe.value(ray.direction) * (1 / density);
    return ray;
}

void decide(int bouncesLeft, PathLevel& level) {
    const bool unlimited = bouncesLeft == kUnlimitedBounces;
    parallelFor(level.vertices.size(), kBatchVertices, [&](const Chunk& chunk) {
        for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
            PathVertex& v = level.vertices[i];
            const float reflectance = highest(v.albedo);
            if (reflectance <= 0 && v.lobe < 0) continue;
            const bool solved = v.item != kNoItem;
            v.directChance = solved ? kDirectChance : 1;
            v.isLit = chanceOf(v, 0) < v.directChance;
            if (bouncesLeft == 0) continue;
            if (reflectance > 0)
                v.diffuseChance = solved ? kBounceChance : roulette(reflectance, unlimited);
            v.sendsDiffuse = chanceOf(v, 1) < v.diffuseChance;
            if (v.lobe < 0) continue;
            const LobeRay ray = lobeRayOf(v, level.lobes[static_cast<std::size_t>(v.lobe)]);
            if (ray.share != Rgb(0, 0, 0)) v.lobeChance = roulette(highest(ray.share), unlimited);
            v.sendsLobe = chanceOf(v, 2) < v.lobeChance;
        }
    });
}

std::uint64_t lightVertices(const Estimator& estimator, const EstimatorPlan* plan,
                            const VertexGroups& groups, Pool<Workspace>& workspaces,
                            PathLevel& level) {
    std::vector<std::uint32_t> lit;
    for (const std::uint32_t i : groups.order)
        if (level.vertices[i].isLit) lit.push_back(i);
    std::vector<std::uint64_t> rays((lit.size() + kBatchVertices - 1) / kBatchVertices);
    parallelFor(lit.size(), kBatchVertices, [&](const Chunk& chunk) {
        std::unique_ptr<Workspace> workspace =
            workspaces.take([&] { return estimator.makeWorkspace(); });
        LitBatch batch(estimator, plan, level);
        for (std::size_t i = chunk.begin; i < chunk.end; ++i) batch.add(lit[i]);
        rays[chunk.index] = batch.light(*workspace);
        workspaces.giveBack(std::move(workspace));
    });
    return std::accumulate(rays.begin(), rays.end(), std::uint64_t{0});
}

}  // namespace shadowcache
