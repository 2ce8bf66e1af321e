#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/emitters/emitters.h"
#include "common/predict/emitter_visibility.h"
#include "common/trace/scene.h"
#include "render/estimators/estimate.h"
#include "render/estimators/light_groups.h"
#include "render/estimators/shading_point.h"

namespace shadowcache {

/// Light of what shines in a set, without bounces: each sample goes to one emitter l, chosen in
/// proportion to E_l (v_l + floor), with E_l its irradiance if nothing is in the way, and v_l the
/// share of it that a cache's items see; without a cache to E_l. Samples are decided before any of
/// their rays. Immutable, thread-safe through one Tools a thread. [docs/estimator.md]
class EmitterLight {
public:
    /// @param emitters    of the scene's mesh
    /// @param cache       that `visibility` is of; null: without one. All outlive this object.
    /// @param visibility  null: it is not known
    EmitterLight(const Scene& scene, const Emitters& emitters, const ShadowCache* cache,
                 const EmitterVisibility* visibility);

    /// Scratch memory of one thread.
    class Tools {
    public:
        explicit Tools(const EmitterLight& light);

    private:
        friend class EmitterLight;

        /// A ray to an emitter, and what it adds where it is free.
        struct Sample {
            std::uint32_t point;
            bool traced = false, visible = false;
            Rgb value{0, 0, 0};
            std::size_t part = 0;  ///< that it goes to
        };
        /// A ray by a lobe; it is visible if it meets an emitter.
        struct LobeRay : Sample {
            Vec3f direction{0};
            float density = 0;
        };

        std::optional<ShadowCache::Reader> reader_;
        std::vector<ItemView> items_;
        std::vector<float> shares_, chances_;
        std::vector<float> chancesOfAll_, predicted_;  ///< by point of a batch
        std::vector<std::uint32_t> words_[3];
        std::vector<Sample> samples_;
        std::vector<LobeRay> lobeRays_;
        std::vector<Emitters::Met> met_;
        RayStream stream_{};
        std::vector<std::uint32_t> queued_;  ///< numbers of the samples in the stream
    };

    /// Adds the irradiance of a batch's points to their estimates: as many rays of each as the
    /// batch wants samples.
    ///
    /// @param luminanceWeights  of the estimates' variance
    /// @param sink  receives the same by group and number of the point
    void addIrradiance(const PointBatch& batch, const Rgb& luminanceWeights, Tools& tools,
                       std::span<Estimate> estimates, const GroupSink& sink = {}) const;

    /// Adds what the lobes of glossy points reflect: by rays to emitters and by rays of the lobes,
    /// weighted by the balance heuristic.
    void addGloss(const PointBatch& batch, std::span<const GlossyPoint> points,
                  const Rgb& luminanceWeights, Tools& tools, std::span<GlossEstimate> estimates,
                  const GroupSink& sink = {}) const;

    /// Irradiance of a place without rays; unoccluded as far as visibility is not known.
    ///
    /// @param sink  receives the same by group, as of place `number`
    Rgb predict(const SetPlace& place, Tools& tools, const GroupSink& sink = {},
                std::size_t number = 0) const;

    /// The same of each item of the cache, by its own counts. @pre there is a visibility
    /// @param place  of an item, in the set's space
    Rgb predictItem(std::uint64_t item, const Receiver& place, Tools& tools,
                    const GroupSink& sink = {}) const;

    /// What lobes reflect, without rays: of each emitter as if it were a point.
    Rgb predictGloss(const GlossyPoint& glossy, Tools& tools, const GroupSink& sink = {},
                     std::size_t number = 0) const;

    /// A lamp that cameras see, where a camera's ray meets it.
    struct SeenLamp {
        std::size_t part = 0;
        float distance = 0;     ///< along the ray; infinite of suns
        Rgb radiance{0, 0, 0};  ///< tinted by the panes on the way
    };
    /// Those in front of what a camera's ray meets.
    ///
    /// @param direction  unit
    /// @param distance   of what the ray meets; infinite: the sky
    std::vector<SeenLamp> lampsSeen(const Vec3f& origin, const Vec3f& direction,
                                    float distance) const;

    const Emitters& emitters() const { return emitters_; }
    bool knowsVisibility() const { return visibility_ != nullptr; }

private:
    /// A direction to an emitter.
    struct Drawn {
        const EmitterPart* part = nullptr;  ///< null: none
        EmitterPoint point;
        Rgb radiance{0, 0, 0};
        float density = 0;  ///< of the direction, by all that chose it [1/sr]

        /// Density for the balance heuristic: that of drawing it, plus `other`, that of rays which
        /// do not aim at emitters. These never meet a lamp without an extent.
        float densityWith(float other) const { return density + (point.isSingle ? 0 : other); }
    };

    void lookUp(const SetPlace& place, Tools& tools) const;
    void lookUp(const ShadingPoint& point, Tools& tools) const;
    float setChances(const Receiver& at, Tools& tools) const;
    void setChancesOfAll(const PointBatch& batch, Tools& tools) const;
    Drawn draw(const Receiver& at, std::size_t k, const Tools& tools) const;
    float chanceOf(std::size_t part, const Receiver& at, const Tools& tools) const;
    std::size_t numberOf(const Drawn& drawn) const;
    Rgb emissionOverDensity(const Hit& hit, const Receiver& at, bool draws, float density,
                            const Tools& tools) const;
    template <class Visit>
    void forLampsOf(const Receiver& at, const Vec3f& direction, float distance,
                    std::vector<Emitters::Met>& met, const Visit& visit) const;
    Rgb lampsMet(const Tools::LobeRay& ray, float distance, const Receiver& at, Tools& tools,
                 const GroupSink& sink) const;
    void enqueue(const SetPlace& place, const Drawn& drawn, const Rgb& value, std::uint32_t number,
                 Tools& tools) const;
    void trace(Tools& tools) const;
    static Tools::LobeRay lobeRay(const GlossyPoint& glossy, std::uint32_t number, float share,
                                  std::size_t k, const Tools& tools);
    void traceLobe(const Receiver& at, bool draws, std::span<Tools::LobeRay> rays, Tools& tools,
                   const GroupSink& sink) const;
    static void addToGroups(const Tools& tools, const GroupSink& sink);

    const Scene& scene_;
    const Emitters& emitters_;
    const ShadowCache* cache_;
    const EmitterVisibility* visibility_;
};

}  // namespace shadowcache
