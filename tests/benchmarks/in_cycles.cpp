#include "tests/benchmarks/in_cycles.h"

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "common/base/error.h"
#include "common/base/parallel.h"
#include "common/image/radiance.h"
#include "tests/benchmarks/antialiased.h"
#include "tests/support/temporary_folder.h"

namespace shadowcache::bench {

namespace {

constexpr double kAlbedo = 0.5;

}  // namespace

RelativeError Pair::noise(const Image& reference) const {
    Image noisy = reference;
    for (std::size_t i = 0; i < noisy.pixels.size(); ++i)
        noisy.pixels[i] += (a.pixels[i] - b.pixels[i]) * std::sqrt(0.5f);
    return relativeError(noisy, reference);
}

Pair cyclesPair(const Settings& settings, const Frame& frame, int samples, int bounces) {
    const test::TemporaryFolder folder;
    const std::filesystem::path request = folder.path() / "request.json",
                                stats = folder.path() / "stats.json", log = folder.path() / "log",
                                a = folder.path() / "a.exr", b = folder.path() / "b.exr";
    const SetFiles files = setFiles(settings, frame.set.name);
    const RenderOptions& options = wholeView().options;
    std::ofstream(request) << nlohmann::json{
        {"set", std::filesystem::absolute(files.mesh)},
        {"camera", std::filesystem::absolute(files.cameras)},
        {"map", std::filesystem::absolute(mapFile(settings, frame.map))},
        {"frame", frame.number},
        {"size", {options.width, options.height}},
        {"albedo", kAlbedo},
        {"samples", samples},
        {"bounces", bounces},
        {"threads", threadCount()},
        {"pictures", {a, b}},
        {"stats", stats}};
    // Blender's Python takes its modules from where the first python3 of PATH has them.
    const std::string command =
        "PATH=/usr/bin:$PATH blender -b --factory-startup --python-exit-code 1 "
        "--python " SHADOWCACHE_BENCHMARKS "/render_in_cycles.py -- '" +
        request.string() + "' > '" + log.string() + "' 2>&1";
    if (std::system(command.c_str()) != 0)
        throw Error("Blender failed (Debian package: blender):\n" + test::readBytes(log));
    const double seconds = nlohmann::json::parse(std::ifstream(stats)).at("processor_seconds");
    return {readRadiance(a).image, readRadiance(b).image, seconds / threadCount()};
}

}  // namespace shadowcache::bench
