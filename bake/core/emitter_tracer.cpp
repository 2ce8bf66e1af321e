#include "bake/core/emitter_tracer.h"

#include <array>
#include <span>

#include "common/base/tuned.h"
#include "common/cache/emitter_code.h"
#include "common/emitters/emitter_ray.h"
#include "common/random/salts.h"
#include "common/random/sequence.h"

namespace shadowcache {

namespace {

/// Rays to an emitter that decide whether it gets more.
SHADOWCACHE_TUNED(int, kEmitterRays, 16);

/// Rays to an emitter that is seen in part, these included.
SHADOWCACHE_TUNED(int, kPartRays, 64);

/// Rays from origins of a patch to points of emitters.
class EmitterTracer {
public:
    EmitterTracer(const Scene& scene, const Emitters& emitters, const Patch& patch)
        : scene_(scene), emitters_(emitters), patch_(patch), counts_(emitters.size()) {}

    struct Count {
        int visible = 0, rays = 0;
    };

    /// Rays `first` to `end - 1` to an emitter.
    void add(std::size_t emitter, int first, int end) {
        const std::uint64_t seed = hashWords(patch_.seed, BakeSalt::emitterRays, emitter);
        std::array<std::vector<std::uint32_t>, 3> words;
        for (int d = 0; d < 3; ++d) {
            auto& some = words[static_cast<std::size_t>(d)];
            some.resize(static_cast<std::size_t>(end - first));
            owenSobol(static_cast<std::uint32_t>(first), d, seed, some);
        }
        const auto number = [&](std::size_t d, int k) {
            return static_cast<double>(toUnitFloat(words[d][static_cast<std::size_t>(k - first)]));
        };
        for (int k = first; k < end; ++k)
            addOne(emitter, originOf(seed, k), {number(0, k), number(1, k), number(2, k)});
    }

    void flush() {
        if (queued_ == 0) return;
        scene_.trace(rays_, queued_);
        for (std::size_t i = 0; i < queued_; ++i) {
            Count& count = counts_[of_[i]];
            ++count.rays;
            count.visible += rays_.reach[i] >= 0 ? 1 : 0;
        }
        traced_ += queued_;
        queued_ = 0;
    }

    const Count& count(std::size_t emitter) const { return counts_[emitter]; }
    std::uint64_t traced() const { return traced_; }

private:
    /// Neighbouring rays start far from each other: the step has no factor in common with 64.
    static std::size_t originOf(std::uint64_t seed, int k) {
        constexpr std::size_t kStep = 27;
        return (seed + static_cast<std::size_t>(k) * kStep) % Patch::kOrigins;
    }

    void addOne(std::size_t emitter, std::size_t origin, std::array<double, 3> numbers) {
        const Receiver at{patch_.origin[origin], patch_.originNormal[origin]};
        const Emitters::Choice chosen = emitters_.choose(emitter, at, numbers[0]);
        if (!(chosen.chance > 0)) return;
        const EmitterPart& part = emitters_.parts()[chosen.part];
        const EmitterPoint point = samplePoint(part, at, numbers[1], numbers[2]);
        if (!(point.density > 0) || !(point.direction.dot(at.normal) > 0)) return;
        const EmitterRay ray = rayTo(scene_, part, point, at.position);
        for (int c = 0; c < 3; ++c) {
            rays_.origin[c][queued_] = at.position[c];
            rays_.direction[c][queued_] = ray.way[c];
        }
        rays_.reach[queued_] = ray.reach;
        of_[queued_++] = static_cast<std::uint32_t>(emitter);
        if (queued_ == RayStream::kSize) flush();
    }

    const Scene& scene_;
    const Emitters& emitters_;
    const Patch& patch_;
    std::vector<Count> counts_;
    RayStream rays_{};
    std::uint32_t of_[RayStream::kSize] = {};
    std::size_t queued_ = 0;
    std::uint64_t traced_ = 0;
};

}  // namespace

Emitters bakedEmitters(const TriangleMesh& mesh, const BakeOptions& options) {
    const TriangleMesh* const meshes[] = {&mesh};
    return Emitters(std::span(meshes).first(options.lamps ? 1 : 0), EmitterWeight::shape);
}

std::uint64_t traceEmitters(const Scene& scene, const Emitters& emitters, const Patch& patch,
                            std::vector<std::uint16_t>& out) {
    EmitterTracer tracer(scene, emitters, patch);
    for (std::size_t e = 0; e < emitters.size(); ++e) tracer.add(e, 0, kEmitterRays);
    tracer.flush();
    for (std::size_t e = 0; e < emitters.size(); ++e) {
        const auto& count = tracer.count(e);
        if (count.visible > 0 && count.visible < count.rays) tracer.add(e, kEmitterRays, kPartRays);
    }
    tracer.flush();
    for (std::size_t e = 0; e < emitters.size(); ++e)
        out.push_back(EmitterCode::of(tracer.count(e).visible, tracer.count(e).rays));
    return tracer.traced();
}

}  // namespace shadowcache
