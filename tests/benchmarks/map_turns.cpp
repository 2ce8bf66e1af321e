// How long maps take to read and to tabulate, and to be turned.

#include <algorithm>
#include <cstdio>
#include <ctime>

#include "common/base/process.h"
#include "common/image/exr.h"
#include "common/image/radiance.h"
#include "common/random/sequence.h"
#include "tests/benchmarks/bench.h"

namespace shadowcache::bench {

namespace {

constexpr int kTurns = 50;

/// A map of `width` texels a row as an EXR of half floats: the first of the settings, its texels
/// repeated, with noise that no compression removes.
std::filesystem::path wideMap(const Settings& settings, int width) {
    const Image map = readRadiance(mapFile(settings, settings.maps.front())).image;
    const int height = width / 2;
    std::vector<Channel> channels{{"R", {}}, {"G", {}}, {"B", {}}};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const auto row = static_cast<std::size_t>(std::int64_t{y} * map.height / height);
            const auto column = static_cast<std::size_t>(std::int64_t{x} * map.width / width);
            const Rgb& texel = map.pixels[row * static_cast<std::size_t>(map.width) + column];
            for (std::size_t k = 0; k < channels.size(); ++k) {
                const double noise = toUnit(
                    hashWords(static_cast<std::uint64_t>(y), static_cast<std::uint64_t>(x), k));
                channels[k].values.push_back(texel[static_cast<int>(k)] *
                                             static_cast<float>(0.9 + 0.2 * noise));
            }
        }
    const auto path = settings.work / ("map_" + std::to_string(width) + ".exr");
    std::filesystem::create_directories(settings.work);
    writeExr(path, width, height, channels, {}, PixelType::half);
    return path;
}

}  // namespace

void mapTurns(const Settings& settings) {
    JsonFile json;
    std::printf("%6s %9s %9s %12s %12s %15s\n", "width", "read", "tabulate", "turn, best",
                "turn, mean", "processor time");
    for (const int width : {1024, 2048, 4096, 8192}) {
        const auto path = wideMap(settings, width);
        const double start = secondsNow();
        const RadianceImage image = readRadiance(path);
        const double read = secondsNow() - start;
        const auto map =
            std::make_shared<const EnvironmentMap>(image.image, image.luminanceWeights);
        const double tabulate = secondsNow() - start - read;
        Environment environment(map);
        double best = 1e9, sum = 0;
        const std::clock_t spent = std::clock();
        for (int i = 1; i <= kTurns; ++i) {
            const double before = secondsNow();
            environment.turn(turnByAngles({3.0 * i, 7.0 * i, 11.0 * i}), Rgb(1.0f));
            const double seconds = secondsNow() - before;
            best = std::min(best, seconds);
            sum += seconds;
        }
        const double processor = static_cast<double>(std::clock() - spent) / CLOCKS_PER_SEC;
        std::printf("%6d %7.3f s %7.3f s %9.2f ms %9.2f ms %12.2f ms\n", width, read, tabulate,
                    1e3 * best, 1e3 * sum / kTurns, 1e3 * processor / kTurns);
        std::fflush(stdout);
        const std::string key = "width" + std::to_string(width);
        json.set(key + ".read", read);
        json.set(key + ".tabulate", tabulate);
        json.set(key + ".turn", sum / kTurns);
    }
    if (!settings.json.empty()) json.write(settings.json);
}

}  // namespace shadowcache::bench
