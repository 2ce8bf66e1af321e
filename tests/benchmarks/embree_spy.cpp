#include "tests/benchmarks/embree_spy.h"

#include <dlfcn.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>

#include "common/base/error.h"

namespace shadowcache::bench {

namespace {

/// Calls of a burst: consecutive rays stay together.
constexpr std::uint64_t kBurstCalls = 8;
/// Bursts that a thread keeps: 2 M rays in streams of 256.
constexpr std::size_t kMostBursts = 1024;

using Clock = std::chrono::steady_clock;

/// One thread's share.
struct Ledger {
    std::uint64_t rays = 0, calls = 0;
    Clock::duration time{0};
    std::vector<Burst> bursts;
    std::uint64_t burstsApart = 1;  ///< one burst in how many is kept
};

std::atomic<Spying> mode{Spying::off};
std::atomic<std::uint64_t> generation{0};
std::atomic<RTCScene> seenScene{nullptr};
std::mutex mutex;
std::vector<std::unique_ptr<Ledger>> ledgers;

Ledger& ledger() {
    thread_local Ledger* mine = nullptr;
    thread_local std::uint64_t mineSince = 0;
    if (!mine || mineSince != generation) {
        const std::lock_guard lock(mutex);
        ledgers.push_back(std::make_unique<Ledger>());
        mine = ledgers.back().get();
        mineSince = generation;
    }
    return *mine;
}

/// Whether this call belongs to a burst that is kept. When there are too many, every other one
/// goes, so that the sample spreads over the whole bake, however long it is.
bool isKept(Ledger& l) {
    const std::uint64_t call = l.calls - 1;
    if (call % kBurstCalls == 0 && l.bursts.size() == kMostBursts) {
        for (std::size_t i = 0; i < kMostBursts / 2; ++i) l.bursts[i] = std::move(l.bursts[2 * i]);
        l.bursts.resize(kMostBursts / 2);
        l.burstsApart *= 2;
    }
    if (call / kBurstCalls % l.burstsApart != 0) return false;
    if (call % kBurstCalls == 0) l.bursts.emplace_back();
    return true;
}

void keep(Burst& burst, const RTCRay& r) {
    burst.push_back({r.org_x, r.org_y, r.org_z, r.dir_x, r.dir_y, r.dir_z, r.tfar});
}

/// Lane `i` of a packet.
void keep(Burst& burst, const RTCRay8& r, int i) {
    burst.push_back(
        {r.org_x[i], r.org_y[i], r.org_z[i], r.dir_x[i], r.dir_y[i], r.dir_z[i], r.tfar[i]});
}

/// Forwards a call of `rays` rays; `record` appends them to a burst.
template <class Forward, class Record>
void pass(std::uint64_t rays, RTCScene target, const Forward& forward, const Record& record) {
    const Spying now = mode.load(std::memory_order_relaxed);
    if (now == Spying::off) return forward();
    Ledger& l = ledger();
    ++l.calls;
    l.rays += rays;
    if (now == Spying::record && isKept(l)) {
        seenScene.store(target, std::memory_order_relaxed);
        record(l.bursts.back());
    }
    if (now != Spying::time) return forward();
    const auto start = Clock::now();
    forward();
    l.time += Clock::now() - start;
}

template <class Function>
Function* original(const char* name) {
    void* found = dlsym(RTLD_NEXT, name);
    if (!found) throw Error(std::string("Embree has no ") + name);
    return reinterpret_cast<Function*>(found);
}

int laneCount(const int* valid) {
    return static_cast<int>(std::count(valid, valid + 8, -1));
}

/// Seconds that two looks at the clock add to what lies between them.
double clockCost() {
    constexpr int looks = 1 << 16;
    Clock::duration sum{0};
    for (int i = 0; i < looks; ++i) {
        const auto start = Clock::now();
        sum += Clock::now() - start;
    }
    return std::chrono::duration<double>(sum).count() / looks;
}

}  // namespace

void spy(Spying wanted) {
    mode = Spying::off;
    const std::lock_guard lock(mutex);
    ledgers.clear();
    ++generation;
    mode = wanted;
}

Spied endSpying() {
    mode = Spying::off;
    const std::lock_guard lock(mutex);
    Spied sum;
    for (const auto& l : ledgers) {
        sum.rays += l->rays;
        sum.calls += l->calls;
        sum.seconds += std::chrono::duration<double>(l->time).count();
        std::move(l->bursts.begin(), l->bursts.end(), std::back_inserter(sum.bursts));
    }
    sum.seconds = std::max(0.0, sum.seconds - clockCost() * static_cast<double>(sum.calls));
    return sum;
}

RTCScene lastScene() {
    return seenScene;
}

}  // namespace shadowcache::bench

using namespace shadowcache::bench;

extern "C" {

void rtcOccluded1(RTCScene scene, RTCIntersectContext* context, RTCRay* ray) {
    static const auto real = original<decltype(rtcOccluded1)>("rtcOccluded1");
    pass(
        1, scene, [&] { real(scene, context, ray); }, [&](Burst& burst) { keep(burst, *ray); });
}

void rtcIntersect1(RTCScene scene, RTCIntersectContext* context, RTCRayHit* query) {
    static const auto real = original<decltype(rtcIntersect1)>("rtcIntersect1");
    pass(
        1, scene, [&] { real(scene, context, query); },
        [&](Burst& burst) { keep(burst, query->ray); });
}

void rtcOccluded8(const int* valid, RTCScene scene, RTCIntersectContext* context, RTCRay8* rays) {
    static const auto real = original<decltype(rtcOccluded8)>("rtcOccluded8");
    const int count = laneCount(valid);
    pass(
        static_cast<std::uint64_t>(count), scene, [&] { real(valid, scene, context, rays); },
        [&](Burst& burst) {
            for (int i = 0; i < count; ++i) keep(burst, *rays, i);
        });
}

void rtcIntersect8(const int* valid, RTCScene scene, RTCIntersectContext* context,
                   RTCRayHit8* query) {
    static const auto real = original<decltype(rtcIntersect8)>("rtcIntersect8");
    const int count = laneCount(valid);
    pass(
        static_cast<std::uint64_t>(count), scene, [&] { real(valid, scene, context, query); },
        [&](Burst& burst) {
            for (int i = 0; i < count; ++i) keep(burst, query->ray, i);
        });
}

void rtcOccludedNp(RTCScene scene, RTCIntersectContext* context, const RTCRayNp* rays,
                   unsigned int count) {
    static const auto real = original<decltype(rtcOccludedNp)>("rtcOccludedNp");
    pass(
        count, scene, [&] { real(scene, context, rays, count); },
        [&](Burst& burst) {
            for (unsigned i = 0; i < count; ++i)
                burst.push_back({rays->org_x[i], rays->org_y[i], rays->org_z[i], rays->dir_x[i],
                                 rays->dir_y[i], rays->dir_z[i], rays->tfar[i]});
        });
}

}  // extern "C"
