#include "render/bounces/path_steps.h"

#include <algorithm>
#include <array>

#include "common/base/parallel.h"
#include "common/mesh/placed_mesh.h"
#include "common/random/salts.h"
#include "render/bounces/russian_roulette.h"
#include "render/bounces/vertex_items.h"
#include "render/estimators/hemisphere.h"
#include "render/estimators/light_groups.h"
#include "render/estimators/set_place.h"

namespace shadowcache {

namespace {

/// Vertices whose rays one thread traces at a time.
constexpr std::size_t kVerticesOfChunk = 1024;

/// A ray and what it is for.
struct PathRay {
    Vec3f direction;
    std::uint32_t from;  ///< vertex that sends it
    bool ofLobe;
    Rgb share;                      ///< by which radiance that it finds counts at `from`, alone
    float cosine = 0, density = 0;  ///< as VertexChildren has them
};

/// One chunk of a level's vertices: their rays, and what these meet.
class Steps {
public:
    Steps(const EstimatorContext& context, const PlainLook& plain, const PathLevel& level)
        : scene_(context.scene),
          plain_(plain),
          weights_(context.environment.luminanceWeights()),
          emitters_(context.emitters),
          groups_(context.groups),
          level_(level.at),
          choices_(level.choices),
          guides_(level.guides) {}

    /// A vertex that a ray met.
    struct Met {
        PathVertex vertex;
        std::uint32_t from;
        bool byLobe;
        bool moves;
        float cosine, density;  ///< as VertexChildren has them
    };

    void run(std::span<const std::uint32_t> vertices, const DirectionNumbers& numbers) {
        for (const std::uint32_t from : vertices) {
            if (choices_[from].sendsDiffuse) sendDiffuse(from, numbers[from]);
            if (choices_[from].sendsLobe) sendLobe(from);
        }
        trace();
    }

    std::vector<Met> met;
    std::vector<GlossyLobe> lobes;  ///< of `met`
    std::size_t rayCount() const { return rays_.size(); }

private:
    void sendDiffuse(std::uint32_t from, const std::array<float, 2>& numbers) {
        const PathVertex& v = level_.vertices[from];
        const DirectionGuide& guide = guides_.of(from);
        const auto [direction, part] = guide.draw(v.origin, v.normal, numbers);
        const float cosine = direction.dot(v.normal);
        if (direction.dot(v.geometricNormal) <= 0 || (cosine <= 0 && !guide.isCosine())) return;
        const float density = guide.density(v.origin, cosine, direction, part);
        const Rgb share = guide.isCosine() ? v.albedo : v.albedo * (cosine / density);
        rays_.push_back({direction, from, false, share, cosine, density});
    }

    void sendLobe(std::uint32_t from) {
        const PathVertex& v = level_.vertices[from];
        const LobeRay ray = lobeRayOf(v, level_.lobeOf(v));
        if (ray.share != Rgb(0, 0, 0)) rays_.push_back({ray.direction, from, true, ray.share});
    }

    void trace() {
        constexpr auto kSize = static_cast<std::size_t>(RayPacket::kSize);
        RayPacket packet{};
        std::array<Hit, kSize> hits;
        for (std::size_t first = 0; first < rays_.size(); first += kSize) {
            const std::size_t count = std::min(kSize, rays_.size() - first);
            for (std::size_t i = 0; i < count; ++i)
                packet.set(static_cast<int>(i), level_.vertices[rays_[first + i].from].origin,
                           rays_[first + i].direction);
            scene_.meet(packet, static_cast<int>(count), hits.data());
            for (std::size_t i = 0; i < count; ++i)
                if (hits[i].found) add(rays_[first + i], hits[i]);
        }
    }

    void add(const PathRay& ray, const Hit& hit) {
        const View view{ray.direction, hit};
        const bool back = hit.normal.dot(ray.direction) > 0;
        if (back && !isDoubleSided(hit.scene->mesh(), hit.triangle)) return;
        const PathVertex& from = level_.vertices[ray.from];
        const VertexChoice& choice = choices_[ray.from];
        const Surface surface = surfaceOf(hit, plain_);
        PathVertex v;
        v.normal = view.shadingNormal();
        v.geometricNormal = view.geometricNormal();
        v.origin = rayStartOf(scene_, view);
        v.target = hit.scene->rayOrigin(hit.position, hit.triangle, v.geometricNormal);
        v.albedo =
            surface.unlit ? Rgb(0, 0, 0) : diffuseAlbedo(surface, -v.normal.dot(ray.direction));
        // That of emitters is part of the direct light.
        if (!emitters_ || hit.scene != &scene_) v.emission = surface.emission;
        if (groups_ && v.emission != Rgb(0, 0, 0))
            v.emissionGroup = static_cast<std::uint32_t>(groups_->ofHit(hit));
        v.seed = v.pixelSeed = hashWords(
            from.seed, ray.ofLobe ? RenderSalt::bounceLobeChild : RenderSalt::bounceChild);
        v.errorScale = from.errorScale;
        const Rgb share = ray.share * hit.tint;
        v.weight = from.weight * std::max(0.0f, share.dot(weights_)) /
                   (ray.ofLobe ? choice.lobeChance : choice.diffuseChance);
        v.tint = hit.tint;
        if (ray.ofLobe) v.throughLobe = share;
        if (surface.glossy) {
            v.lobe = static_cast<std::int32_t>(lobes.size());
            lobes.emplace_back(surface, v.normal, -ray.direction);
        }
        met.push_back({v, ray.from, ray.ofLobe, hit.scene != &scene_, ray.cosine, ray.density});
    }

    const Scene& scene_;
    const PlainLook& plain_;
    const Rgb weights_;
    const EmitterLight* emitters_;
    const LightGroups* groups_;
    const PathVertices& level_;
    const std::span<const VertexChoice> choices_;
    const Guides& guides_;
    std::vector<PathRay> rays_;
};

}  // namespace

PathVertices firstVertices(std::span<const BounceReceiver> receivers, const Rgb& luminanceWeights) {
    PathVertices level;
    level.vertices.resize(receivers.size());
    for (std::size_t i = 0; i < receivers.size(); ++i) {
        const BounceReceiver& receiver = receivers[i];
        const auto& [place, slot] = *receiver.point;
        PathVertex& v = level.vertices[i];
        v.origin = v.target = place.rayOrigin;
        v.normal = place.normal;
        v.geometricNormal = place.geometricNormal;
        v.albedo = receiver.diffuseAlbedo;
        v.seed = hashWords(slot.seed, RenderSalt::bounceFirst, slot.cameraRay);
        v.pixelSeed = slot.seed;
        v.errorScale = slot.errorScale *
                       std::max(receiver.diffuseAlbedo.dot(luminanceWeights), 1e-6f) *
                       static_cast<float>(1 / kPi);
        if (!receiver.lobe) continue;
        v.lobe = static_cast<std::int32_t>(level.lobes.size());
        level.lobes.push_back(*receiver.lobe);
    }
    return level;
}

DirectionNumbers firstNumbers(std::span<const BounceReceiver> receivers) {
    DirectionNumbers numbers(receivers.size());
    std::vector<std::uint32_t> word(1);
    for (std::size_t i = 0; i < receivers.size(); ++i) {
        const BatchSlot& slot = receivers[i].point->slot;
        const std::uint64_t sequence = hashWords(slot.seed, RenderSalt::bounceSequence);
        for (const std::size_t k : {0u, 1u}) {
            owenSobol(slot.cameraRay, static_cast<int>(k), sequence, word);
            numbers[i][k] = toUnitFloat(word[0]);
        }
    }
    return numbers;
}

PathStep nextVertices(const EstimatorContext& context, const PlainLook& plain,
                      const PathLevel& level, const DirectionNumbers& numbers) {
    const std::span<const std::uint32_t> order = level.groups.order;
    std::vector<std::vector<Steps::Met>> met((order.size() + kVerticesOfChunk - 1) /
                                             kVerticesOfChunk);
    std::vector<std::vector<GlossyLobe>> lobes(met.size());
    std::vector<std::uint64_t> counts(met.size());
    parallelFor(order.size(), kVerticesOfChunk, [&](const Chunk& chunk) {
        Steps steps(context, plain, level);
        steps.run(order.subspan(chunk.begin, chunk.end - chunk.begin), numbers);
        counts[chunk.index] = steps.rayCount();
        met[chunk.index] = std::move(steps.met);
        lobes[chunk.index] = std::move(steps.lobes);
    });
    PathStep step;
    step.children.resize(level.size());
    std::vector<PathVertex>& next = step.next.vertices;
    std::vector<std::uint32_t> ofSet;  // items are of the set alone, not of what moves
    for (std::size_t c = 0; c < met.size(); ++c) {
        step.rays += counts[c];
        const auto firstLobe = static_cast<std::int32_t>(step.next.lobes.size());
        step.next.lobes.insert(step.next.lobes.end(), lobes[c].begin(), lobes[c].end());
        for (Steps::Met& found : met[c]) {
            if (found.vertex.isGlossy()) found.vertex.lobe += firstLobe;
            VertexChildren& children = step.children[found.from];
            (found.byLobe ? children.lobe : children.diffuse) =
                static_cast<std::int32_t>(next.size());
            if (!found.byLobe) {
                children.cosine = found.cosine;
                children.density = found.density;
            }
            if (!found.moves) ofSet.push_back(static_cast<std::uint32_t>(next.size()));
            next.push_back(found.vertex);
        }
        met[c] = {};
    }
    if (context.solve) findItems(context.solve->items(), context.scene.mesh().origin, ofSet, next);
    return step;
}

}  // namespace shadowcache
