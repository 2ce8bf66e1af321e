#include "bake/core/emitter_tracer.h"

#include <algorithm>

#include "common/base/tuned.h"
#include "common/cache/emitter_code.h"
#include "common/random/salts.h"

namespace shadowcache {

namespace {

/// Rays to an emitter that decide whether it gets more.
SHADOWCACHE_TUNED(int, kPilotRays, 16);

/// Rays to one that is seen in part, with the pilot's.
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
        for (int k = first; k < end; ++k) addOne(emitter, k);
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
    void addOne(std::size_t emitter, int k) {
        // The origins of neighbouring rays are far from each other: the step has no factor in
        // common with 64. Each ray has a stratum of what chooses the triangle.
        constexpr std::size_t kStep = 27;
        const std::uint64_t h = hashWords(patch_.seed, BakeSalt::emitterRays, emitter);
        const std::size_t origin = (h + static_cast<std::size_t>(k) * kStep) % Patch::kOrigins;
        const Receiver at{patch_.origin[origin], patch_.originNormal[origin]};
        double choice =
            (k % kPilotRays + toUnit(hashWords(h, 3 * static_cast<unsigned>(k)))) / kPilotRays;
        const Emitters::Choice chosen = emitters_.choose(emitter, at, choice);
        if (!(chosen.chance > 0)) return;
        const EmissiveTriangle& t = emitters_.triangles()[chosen.triangle];
        const EmitterPoint point =
            samplePoint(t, at, toUnit(hashWords(h, 3 * static_cast<unsigned>(k) + 1)),
                        toUnit(hashWords(h, 3 * static_cast<unsigned>(k) + 2)));
        if (!(point.density > 0) || !(point.direction.dot(at.normal) > 0)) return;
        const bool front = t.normal.dot(point.direction) < 0;
        const Vec3f way =
            scene_.rayOrigin(point.position, t.placed, front ? t.normal : -t.normal) - at.position;
        for (int c = 0; c < 3; ++c) {
            rays_.origin[c][queued_] = at.position[c];
            rays_.direction[c][queued_] = way[c];
        }
        rays_.reach[queued_] = 1;
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

std::uint64_t traceEmitters(const Scene& scene, const Emitters& emitters, const Patch& patch,
                            std::vector<std::uint16_t>& out) {
    EmitterTracer tracer(scene, emitters, patch);
    for (std::size_t e = 0; e < emitters.size(); ++e) tracer.add(e, 0, kPilotRays);
    tracer.flush();
    for (std::size_t e = 0; e < emitters.size(); ++e) {
        const auto& count = tracer.count(e);
        if (count.visible > 0 && count.visible < count.rays) tracer.add(e, kPilotRays, kPartRays);
    }
    tracer.flush();
    for (std::size_t e = 0; e < emitters.size(); ++e)
        out.push_back(EmitterCode::of(tracer.count(e).visible, tracer.count(e).rays));
    return tracer.traced();
}

}  // namespace shadowcache
