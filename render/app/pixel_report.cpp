#include "render/app/pixel_report.h"

#include <fmt/core.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <string>

#include "common/base/error.h"

namespace shadowcache {

namespace {

template <class Vector>
std::string text(const Vector& v) {
    char buffer[96];
    std::snprintf(buffer, sizeof buffer, "%.9g, %.9g, %.9g", static_cast<double>(v.x),
                  static_cast<double>(v.y), static_cast<double>(v.z));
    return buffer;
}

void printItems(const EstimatorContext& context, const ShadingPoint& point) {
    if (!context.cache) return;
    ShadowCache::Reader reader(*context.cache);
    std::array<ItemView, ShadowCache::kMaxItems> items;
    const int count = reader.lookUp(point.place.position, point.place.geometricNormal, items);
    std::printf("  cache items: %d, weights:", count);
    for (int i = 0; i < count; ++i)
        std::printf(" %.4f", static_cast<double>(items[static_cast<std::size_t>(i)].weight));
    std::printf("\n");
}

void printSample(const EstimatorContext& context, const ShadingPoint& point, std::size_t i,
                 const Vec3f& direction) {
    std::printf("  sample %zu: ", i);
    if (direction == Vec3f(0, 0, 0)) {
        std::printf("no ray: its contribution is 0 whether occluded or not\n");
        return;
    }
    RayPacket packet{};
    packet.set(0, point.place.rayOrigin, direction);
    float distance = 0;
    context.scene.distances(packet, 1, &distance);
    std::printf("direction %s, cosine %.6f, ", text(direction).c_str(),
                static_cast<double>(point.place.normal.dot(direction)));
    if (std::isinf(distance))
        std::printf("visible, radiance %s\n",
                    text(context.environment.radiance(direction)).c_str());
    else
        std::printf("occluded at distance %.6g\n", static_cast<double>(distance));
}

}  // namespace

void reportPixel(const FrameRequest& frame, int x, int y) {
    const EstimatorContext& context = frame.estimator.context();
    std::printf("frame %d, pixel %d,%d, seed %llu:\n", frame.number, x, y,
                static_cast<unsigned long long>(frame.options.seed));
    const auto report = [&](const CameraSample& sample) {
        const ShadingPoint& point = sample.point;
        std::printf("  position: %s\n  normal: %s\n  ray origin (from the set's): %s\n",
                    text(point.place.position).c_str(), text(point.place.normal).c_str(),
                    text(point.place.rayOrigin).c_str());
        if (sample.share != 1)
            std::printf(
                "  counts as %.4g of a ray, as do its colours: panes are shown more often\n",
                static_cast<double>(sample.share));
        printItems(context, point);
        for (std::size_t i = 0; i < sample.directions.size(); ++i)
            printSample(context, point, i, sample.directions[i]);
        std::printf(
            "  irradiance: %s; variance %.6g; %u shadow rays of its own, %u that reuse "
            "samples of others; albedo: %s\n",
            text(sample.estimate.irradiance).c_str(), static_cast<double>(sample.estimate.variance),
            sample.estimate.rays, sample.estimate.reused, text(sample.surface.baseColor).c_str());
        if (sample.surface.glossy)
            std::printf("  glossy: %s; variance %.6g; %u shadow rays; roughness %.4g\n",
                        text(sample.gloss.radiance).c_str(),
                        static_cast<double>(sample.gloss.variance), sample.gloss.rays,
                        static_cast<double>(sample.surface.roughness));
        if (sample.surface.emission != Rgb(0.0f))
            std::printf("  emission: %s\n", text(sample.surface.emission).c_str());
    };
    const Pixel pixel = renderPixel(frame, x, y, report);
    if (pixel.depth == 0) std::printf("  sees the environment\n");
    std::printf("  colour: %s\n", text(pixel.color).c_str());
    if (!isFinite(pixel)) throw Error(fmt::format("pixel {},{}: the estimate is not finite", x, y));
}

}  // namespace shadowcache
