#include "tests/benchmarks/bare_embree.h"

#include <algorithm>
#include <ctime>

#include "common/base/parallel.h"

namespace shadowcache::bench {

namespace {

constexpr int kRounds = 3;
constexpr unsigned kStreamRays = 256;  ///< per call of rtcOccluded1M

double clockSeconds(clockid_t clock) {
    timespec now{};
    clock_gettime(clock, &now);
    return static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec) * 1e-9;
}

RTCIntersectContext makeContext(RTCIntersectContextFlags flags) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = flags;
    return context;
}

std::vector<RTCRay> singles(const Burst& burst) {
    std::vector<RTCRay> rays;
    rays.reserve(burst.size());
    for (const auto& r : burst) {
        RTCRay ray{};
        ray.org_x = r[0];
        ray.org_y = r[1];
        ray.org_z = r[2];
        ray.dir_x = r[3];
        ray.dir_y = r[4];
        ray.dir_z = r[5];
        ray.tfar = r[6];
        ray.mask = ~0u;
        rays.push_back(ray);
    }
    return rays;
}

/// The burst in packets; what does not fill one is left out.
std::vector<RTCRay8> packets(const Burst& burst) {
    std::vector<RTCRay8> rays(burst.size() / 8);
    for (std::size_t i = 0; i < rays.size() * 8; ++i) {
        RTCRay8& packet = rays[i / 8];
        const std::size_t lane = i % 8;
        packet.org_x[lane] = burst[i][0];
        packet.org_y[lane] = burst[i][1];
        packet.org_z[lane] = burst[i][2];
        packet.dir_x[lane] = burst[i][3];
        packet.dir_y[lane] = burst[i][4];
        packet.dir_z[lane] = burst[i][5];
        packet.tfar[lane] = burst[i][6];
        packet.mask[lane] = ~0u;
    }
    return rays;
}

void traceSingles(RTCScene scene, std::vector<RTCRay>& rays) {
    RTCIntersectContext context = makeContext(RTC_INTERSECT_CONTEXT_FLAG_NONE);
    for (RTCRay& ray : rays) rtcOccluded1(scene, &context, &ray);
}

void tracePackets(RTCScene scene, std::vector<RTCRay8>& rays) {
    alignas(32) static constexpr int kAll[8] = {-1, -1, -1, -1, -1, -1, -1, -1};
    RTCIntersectContext context = makeContext(RTC_INTERSECT_CONTEXT_FLAG_COHERENT);
    for (RTCRay8& packet : rays) rtcOccluded8(kAll, scene, &context, &packet);
}

void traceStreams(RTCScene scene, std::vector<RTCRay>& rays, RTCIntersectContextFlags flags) {
    RTCIntersectContext context = makeContext(flags);
    for (std::size_t i = 0; i < rays.size(); i += kStreamRays)
        rtcOccluded1M(scene, &context, &rays[i],
                      static_cast<unsigned>(std::min<std::size_t>(kStreamRays, rays.size() - i)),
                      sizeof(RTCRay));
}

/// Mean rate over a few rounds. `fill` makes what `trace` traces.
template <class Fill, class Trace>
double measure(const std::vector<Burst>& bursts, std::size_t raysPerElement, const Fill& fill,
               const Trace& trace) {
    double totalSeconds = 0, totalRays = 0;
    for (int round = 0; round < kRounds; ++round) {
        std::vector<double> seconds(bursts.size()), rays(bursts.size());
        parallelFor(bursts.size(), 1, [&](const Chunk& chunk) {
            auto filled = fill(bursts[chunk.begin]);
            const double start = clockSeconds(CLOCK_THREAD_CPUTIME_ID);
            trace(filled);
            seconds[chunk.index] = clockSeconds(CLOCK_THREAD_CPUTIME_ID) - start;
            rays[chunk.index] = static_cast<double>(filled.size() * raysPerElement);
        });
        for (const double s : seconds) totalSeconds += s;
        for (const double r : rays) totalRays += r;
    }
    return totalRays / totalSeconds;
}

}  // namespace

double BareRates::best() const {
    return std::max({single, packet, stream, orderly});
}

BareRates measureBareEmbree(RTCScene scene, const std::vector<Burst>& bursts) {
    BareRates rates;
    rates.single = measure(bursts, 1, singles, [&](auto& rays) { traceSingles(scene, rays); });
    rates.packet = measure(bursts, 8, packets, [&](auto& rays) { tracePackets(scene, rays); });
    rates.stream = measure(bursts, 1, singles, [&](auto& rays) {
        traceStreams(scene, rays, RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT);
    });
    rates.orderly = measure(bursts, 1, singles, [&](auto& rays) {
        traceStreams(scene, rays, RTC_INTERSECT_CONTEXT_FLAG_COHERENT);
    });
    return rates;
}

double processorSeconds() {
    return clockSeconds(CLOCK_PROCESS_CPUTIME_ID);
}

}  // namespace shadowcache::bench
