#include "render/cached/sample_tracer.h"

#include <algorithm>

namespace shadowcache {

SampleTracer::Run SampleTracer::begin(const EstimatorContext& context, const PointBatch& batch,
                                      std::span<const std::uint32_t> members,
                                      std::vector<Misprediction>& found,
                                      std::span<Estimate> estimates) {
    members_ = members;
    partners_.resize(std::max(partners_.size(), batch.points.size()));
    for (const std::uint32_t point : members) partners_[point] = {};
    return {*this, context, batch, found, estimates};
}

/// The squared difference of two neighbours in the order of regions estimates the variance of their
/// sum.
void SampleTracer::Run::add(std::uint32_t point, const Rgb& value) {
    estimates_[point].irradiance += value;
    Partner& partner = tracer_.partners_[point];
    const float luminance = context_.environment.luminance(value);
    if (partner.waits) {
        const float difference = luminance - partner.luminance;
        estimates_[point].variance += difference * difference;
        partner.paired = true;
    }
    partner.luminance = luminance;
    partner.waits = !partner.waits;
}

void SampleTracer::Run::trace(std::uint32_t point, const Vec3f& direction, const Rgb& ifVisible,
                              const Rgb& ifOccluded) {
    Pending& p = tracer_.pending_[tracer_.queued_];
    p.ifVisible = ifVisible;
    p.ifOccluded = ifOccluded;
    p.predicted = Rgb(0, 0, 0);
    p.reuse = 0;
    queue(point, direction);
}

void SampleTracer::Run::traceForReuse(const Misprediction& found, bool ifVisible,
                                      const Rgb& received) {
    Pending& p = tracer_.pending_[tracer_.queued_];
    p.ifVisible = p.ifOccluded = Rgb(0, 0, 0);
    p.predicted = ifVisible ? Rgb(0, 0, 0) : received;
    p.reuse = ifVisible ? 1 : -1;
    p.found = found;
    queue(found.finder, found.direction);
}

void SampleTracer::Run::queue(std::uint32_t point, const Vec3f& direction) {
    tracer_.pending_[tracer_.queued_].point = point;
    tracer_.packet_.set(tracer_.queued_++, batch_.points[point].place.rayOrigin, direction);
    if (tracer_.queued_ == RayPacket::kSize) flush();
}

void SampleTracer::Run::flush() {
    const std::uint32_t visible = context_.scene.visibility(tracer_.packet_, tracer_.queued_);
    for (int k = 0; k < tracer_.queued_; ++k) {
        const Pending& p = tracer_.pending_[k];
        const bool isVisible = (visible >> k & 1u) != 0;
        ++estimates_[p.point].rays;
        if (p.reuse != 0 && isVisible == (p.reuse > 0)) found_.push_back(p.found);
        const bool isTinted = isVisible && context_.scene.tints();
        add(p.point, isTinted ? tintedValue(k) : isVisible ? p.ifVisible : p.ifOccluded);
    }
    tracer_.queued_ = 0;
}

Rgb SampleTracer::Run::tintedValue(int ray) const {
    const RayPacket& rays = tracer_.packet_;
    const Rgb tint =
        context_.scene.tint({rays.originX[ray], rays.originY[ray], rays.originZ[ray]},
                            {rays.directionX[ray], rays.directionY[ray], rays.directionZ[ray]});
    const Pending& p = tracer_.pending_[ray];
    return tinted(p.ifVisible, p.ifOccluded, tint) + p.predicted * (tint - Rgb(1, 1, 1));
}

void SampleTracer::Run::finish() {
    if (tracer_.queued_ > 0) flush();
    for (const std::uint32_t point : tracer_.members_) {
        // Of a single sample only its square is known, next to the variance of a residual.
        const Partner& partner = tracer_.partners_[point];
        if (!partner.waits || partner.paired) continue;
        estimates_[point].variance += partner.luminance * partner.luminance;
    }
}

}  // namespace shadowcache
