#include "render/samples/sample_places.h"

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "common/base/interrupt.h"
#include "common/base/parallel.h"
#include "common/random/salts.h"
#include "common/random/sequence.h"

namespace shadowcache {

namespace {

/// Places of a thread at a time.
constexpr std::size_t kChunk = 256;

/// Samples of a place between two polls for Ctrl-C.
constexpr std::size_t kPolled = 4096;

constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();

}  // namespace

void samplePlaces(const LightSampler& sampler, const Places& places, SampleAim aim,
                  const PlaceSequences& sequences, std::span<LightSample> samples,
                  std::span<Rgb> integrals) {
    std::ranges::fill(samples, LightSample{});
    std::ranges::fill(integrals, Rgb(kNothing));
    if (places.size() == 0) return;
    const std::size_t count = samples.size() / places.size();
    parallelFor(places.size(), kChunk, [&](const Chunk& chunk) {
        LightSampler::Reader reader(sampler);
        std::array<std::vector<std::uint32_t>, 3> words;
        for (auto& of : words) of.resize(count);
        for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
            if (!isPlace(places, i)) continue;
            reader.moveTo(places.positions[i], Vec3f(unitAlong(places.normals[i])), aim);
            integrals[i] = reader.integral();
            if (reader.empty()) continue;
            const std::uint64_t own =
                hashWords(sequences.seed, RenderSalt::placeSamples, sequences.first + i);
            for (int k = 0; k < 3; ++k) owenSobol(0, k, own, words[static_cast<std::size_t>(k)]);
            for (std::size_t k = 0; k < count; ++k) {
                if (k % kPolled == 0) throwIfInterrupted();
                samples[i * count + k] = reader.sample(
                    words[0][k] * 0x1p-32, toUnitFloat(words[1][k]), toUnitFloat(words[2][k]));
            }
        }
    });
}

void readAlong(const LightSampler& sampler, const Places& places, SampleAim aim,
               std::span<const Vec3d> directions, std::span<LightSample> out) {
    std::ranges::fill(out, LightSample{.pdf = std::numeric_limits<double>::quiet_NaN()});
    parallelFor(places.size(), kChunk, [&](const Chunk& chunk) {
        LightSampler::Reader reader(sampler);
        std::size_t at = chunk.end;  // the place that the reader is at
        for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
            if (!isPlace(places, i) || !isDirection(directions[i])) continue;
            if (at == chunk.end || places.positions[i] != places.positions[at] ||
                places.normals[i] != places.normals[at])
                reader.moveTo(places.positions[i], Vec3f(unitAlong(places.normals[i])), aim);
            at = i;
            out[i] = reader.along(Vec3f(unitAlong(directions[i])));
        }
    });
}

}  // namespace shadowcache
