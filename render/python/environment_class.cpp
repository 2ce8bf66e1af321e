#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <array>
#include <cmath>
#include <memory>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "common/base/parallel.h"
#include "common/base/text_streams.h"
#include "common/image/radiance.h"
#include "common/math/turn.h"
#include "common/predict/places.h"
#include "common/random/sequence.h"
#include "render/library/option_table.h"
#include "render/python/arrays.h"
#include "render/python/classes.h"
#include "render/python/long_call.h"
#include "render/python/options.h"
#include "render/shot/light_rotation.h"

namespace shadowcache::python {

namespace py = pybind11;
namespace fs = std::filesystem;

namespace {

/// How a map becomes light.
struct MapTurn {
    Turn turn = {};  ///< as EnvironmentObject has them
    double rotation = 0;
    Rgb gain{1.0f};

    /// Turned further, as a user says it.
    MapTurn then(const LightRotation& by) const {
        if (by.numbers.size() == 1) return {turn, rotation + by.numbers[0], gain};
        return {composed(by.turn(), whole()), 0, gain};
    }
    Turn whole() const {
        const Turn aboutY = turnByAngles({0, rotation, 0});
        return turn == Turn{} ? aboutY : composed(aboutY, turn);
    }

private:
    static Turn composed(const Turn& second, const Turn& first) {
        return {{second.apply(first.axis[0]), second.apply(first.axis[1]),
                 second.apply(first.axis[2])}};
    }
};

MapTurn turnOf(const EnvironmentObject& object) {
    return {object.turn, object.rotation, object.gain};
}

/// Lights a map's tables. To be called without the interpreter's lock, as lit().
std::shared_ptr<EnvironmentObject> turned(EnvironmentObject object, const MapTurn& by) {
    object.turn = by.turn;
    object.rotation = by.rotation;
    object.gain = by.gain;
    object.light = std::make_shared<const Environment>(object.tables, by.whole(), by.gain);
    return std::make_shared<EnvironmentObject>(std::move(object));
}

/// Makes a map's tables and lights them.
std::shared_ptr<EnvironmentObject> lit(const std::string& name,
                                       std::shared_ptr<const RadianceImage> map,
                                       const MapTurn& by) {
    auto tables = std::make_shared<const EnvironmentMap>(map->image, map->luminanceWeights);
    return turned({.name = name, .map = std::move(map), .tables = std::move(tables)}, by);
}

/// The row of an option of the light reads a value. @throws ValueError if it is not finite; Error
LightOptions lightOptionOf(const char* option, const char* name, const py::object& value) {
    const Doubles numbers = doublesOf(value, name);
    for (py::ssize_t i = 0; i < numbers.size(); ++i)
        if (!std::isfinite(numbers.data()[i]))
            throw py::value_error(std::string(name) + ": expected finite numbers");
    RenderJob job;
    const std::vector<OptionRow> rows = optionRows(Part::light, job);
    readOption(*findRow(rows, option), value);
    return job.light;
}

LightRotation rotationOf(const py::object& value) {
    return parseRotation(lightOptionOf("env-rotate", "rotate", value).rotation).first;
}

Rgb gainFrom(const py::object& value) {
    return Rgb(gainOf(lightOptionOf("env-gain", "gain", value).gain));
}

std::shared_ptr<EnvironmentObject> openEnvironment(const fs::path& path, const MapTurn& by,
                                                   const py::object& progress) {
    return longCall(progress, [&] {
        auto environment =
            lit(path.string(), std::make_shared<const RadianceImage>(readRadiance(path)), by);
        environment->path = path;
        return environment;
    });
}

std::shared_ptr<EnvironmentObject> loadEnvironment(const fs::path& path, const py::object& rotate,
                                                   const py::object& gain,
                                                   const py::object& progress) {
    MapTurn by = MapTurn{}.then(rotationOf(rotate));
    by.gain = gainFrom(gain);
    return openEnvironment(path, by, progress);
}

py::array matrixOf(const Turn& turn) {
    std::vector<double> rows;
    for (int row = 0; row < 3; ++row)
        for (const Vec3d& axis : turn.axis) rows.push_back(axis[row]);
    return arrayOf<double>({3, 3}, std::move(rows));
}

py::tuple stateOfEnvironment(const EnvironmentObject& environment) {
    const auto& [x, y, z] = environment.turn.axis;
    const Rgb& gain = environment.gain;
    return py::make_tuple(pickledPath(environment.path, "Environment"), environment.rotation,
                          std::vector<double>{x.x, x.y, x.z, y.x, y.y, y.z, z.x, z.y, z.z},
                          std::vector<float>{gain.x, gain.y, gain.z},
                          environment.light->luminanceIntegral());
}

std::shared_ptr<EnvironmentObject> environmentOfState(const py::tuple& state) {
    const auto path = state[0].cast<std::string>();
    const auto n = state[2].cast<std::vector<double>>();
    const auto gain = state[3].cast<std::vector<float>>();
    const Turn turn{{Vec3d(n.at(0), n.at(1), n.at(2)), Vec3d(n.at(3), n.at(4), n.at(5)),
                     Vec3d(n.at(6), n.at(7), n.at(8))}};
    const MapTurn by{turn, state[1].cast<double>(), Rgb(gain.at(0), gain.at(1), gain.at(2))};
    auto environment = openEnvironment(path, by, py::none());
    requireUnchanged(environment->light->luminanceIntegral() == state[4].cast<double>(), path);
    return environment;
}

/// @throws ValueError
Rgb radianceOf(const Vec3d& color, const std::string& where) {
    for (int k = 0; k < 3; ++k)
        if (!(color[k] >= 0 && color[k] < 3e38))
            throw py::value_error(where + ": expected finite radiance of at least 0");
    return Rgb(color);
}

/// Texels of a map, at most. [EnvironmentMap]
constexpr double kMostTexels = 0x1p31;

std::shared_ptr<EnvironmentObject> environmentOf(const py::object& texels, const py::object& rotate,
                                                 const py::object& progress) {
    const MapTurn by = MapTurn{}.then(rotationOf(rotate));
    const py::array given = numbersOf(texels, "texels");
    if (given.ndim() != 3 || given.shape(2) != 3 || given.size() == 0)
        throw py::value_error("texels: shape " + shapeText(given) +
                              ", expected (height, width, 3) of a lat-long map");
    if (static_cast<double>(given.size()) / 3 > kMostTexels - 1)
        throw py::value_error("texels: shape " + shapeText(given) +
                              ", expected fewer than 2^31 texels");
    const Broadcast all({{"texels", given}});
    RadianceImage map;
    map.image.height = static_cast<int>(given.shape(0));
    map.image.width = static_cast<int>(given.shape(1));
    return longCall(progress, [&] {
        map.image.pixels.reserve(all.size());
        forEachPart(all, kMostOfPart, [&](std::size_t, const auto& vectors) {
            for (const Vec3d& color : vectors[0])
                map.image.pixels.push_back(radianceOf(color, "texels"));
        });
        return lit("array", std::make_shared<const RadianceImage>(std::move(map)), by);
    });
}

std::shared_ptr<EnvironmentObject> constantEnvironment(const py::object& radiance) {
    RadianceImage map;
    map.image = {1, 1, {radianceOf(colorOf(radiance, "radiance"), "radiance")}};
    return longCall(py::none(), [&] {
        return lit("constant", std::make_shared<const RadianceImage>(std::move(map)), {});
    });
}

std::shared_ptr<EnvironmentObject> rotated(const EnvironmentObject& environment,
                                           const py::object& degrees, const py::object& progress) {
    const MapTurn by = turnOf(environment).then(rotationOf(degrees));
    const EnvironmentObject copy = environment;
    return longCall(progress, [&] { return turned(copy, by); });
}

std::shared_ptr<EnvironmentObject> tinted(const EnvironmentObject& environment,
                                          const py::object& gain, const py::object& progress) {
    MapTurn by = turnOf(environment);
    by.gain *= gainFrom(gain);
    const EnvironmentObject copy = environment;
    return longCall(progress, [&] { return turned(copy, by); });
}

/// Texels, samples or directions that a thread takes at a time.
constexpr std::size_t kChunk = 16384;

py::array integrate(const EnvironmentObject& environment, const py::object& progress, int threads) {
    const auto light = environment.light;
    py::array_t<double> out = newArray<double>({3});
    const std::span<double> sums = valuesOf<double>(out);
    runLong(
        progress,
        [&] {
            std::vector<Vec3d> parts((light->texelCount() + kChunk - 1) / kChunk, Vec3d(0.0));
            parallelFor(light->texelCount(), kChunk, [&](const Chunk& chunk) {
                for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
                    const Environment::Texel texel = light->texel(i);
                    parts[chunk.index] +=
                        Vec3d(texel.radiance) * static_cast<double>(texel.solidAngle);
                }
            });
            const Vec3d sum = std::accumulate(parts.begin(), parts.end(), Vec3d(0.0));
            for (int k = 0; k < 3; ++k) sums[static_cast<std::size_t>(k)] = sum[k];
        },
        threads);
    return out;
}

/// Radiances and densities of samples, as arrays.
struct SkySamples {
    py::array_t<float> radiance, density;
    std::span<Rgb> radiances;
    std::span<float> densities;

    explicit SkySamples(const Shape& shape) : density(newArray<float>(shape)) {
        Shape vectors = shape;
        vectors.push_back(3);
        radiance = newArray<float>(vectors);
        radiances = valuesOf<Rgb>(radiance);
        densities = valuesOf<float>(density);
    }
    void write(std::size_t i, const EnvironmentSample& sample) const {
        radiances[i] = sample.radiance;
        densities[i] = sample.density;
    }
};

/// Directions, radiances and densities of `count` samples.
py::tuple sampleEnvironment(const EnvironmentObject& environment, std::uint32_t count,
                            std::uint64_t seed, const py::object& progress, int threads) {
    const auto light = environment.light;
    if (!(light->luminanceIntegral() > 0))
        throw py::value_error("the environment is black, there is nothing to sample");
    const auto n = static_cast<py::ssize_t>(count);
    py::array_t<float> direction = newArray<float>({n, 3});
    const std::span<Vec3f> directions = valuesOf<Vec3f>(direction);
    const SkySamples samples({n});
    const auto unit = [](std::uint32_t word) { return static_cast<float>(word >> 8) * 0x1p-24f; };
    runLong(
        progress,
        [&] {
            parallelFor(count, kChunk, [&](const Chunk& chunk) {
                std::array<std::vector<std::uint32_t>, 3> words;
                for (int k = 0; k < 3; ++k) {
                    auto& of = words[static_cast<std::size_t>(k)];
                    of.resize(chunk.end - chunk.begin);
                    owenSobol(static_cast<std::uint32_t>(chunk.begin), k, seed, of);
                }
                for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
                    const std::size_t at = i - chunk.begin;
                    const EnvironmentSample sample = light->sample(
                        words[0][at] * 0x1p-32, unit(words[1][at]), unit(words[2][at]));
                    directions[i] = sample.direction;
                    samples.write(i, sample);
                }
            });
        },
        threads);
    return py::make_tuple(direction, samples.radiance, samples.density);
}

/// Radiances and densities along directions.
py::tuple lookUp(const EnvironmentObject& environment, const py::object& directions,
                 const py::object& progress, int threads) {
    const auto light = environment.light;
    const Broadcast all({{"directions", directions}});
    const SkySamples samples(all.shape());
    runLong(
        progress,
        [&] {
            forEachPart(all, kMostOfPart, [&](std::size_t first, const auto& vectors) {
                parallelFor(vectors[0].size(), kChunk, [&](const Chunk& chunk) {
                    for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
                        const Vec3d& direction = vectors[0][i];
                        if (!isDirection(direction))
                            throw py::value_error(
                                "directions: expected finite vectors other than 0");
                        samples.write(first + i, light->lookUp(Vec3f(unitAlong(direction))));
                    }
                });
            });
        },
        threads);
    return py::make_tuple(samples.radiance, samples.density);
}

std::string reprOfEnvironment(const EnvironmentObject& environment) {
    TextWriter text;
    text << "<shadowcache.Environment: " << environment.name << ", " << environment.map->image.width
         << " x " << environment.map->image.height << ", rotated by " << environment.rotation
         << " degrees>";
    return text.str();
}

}  // namespace

void defineEnvironment(py::module_& module) {
    py::class_<EnvironmentObject, std::shared_ptr<EnvironmentObject>>(
        module, "Environment",
        "Distant light from a lat-long map: row 0 is +Y, the middle looks to +Z, and the column a\n"
        "quarter of the width left of it to +X, right of it to -X: the sky as seen from within,\n"
        "+Y up. Pickled by its file.")
        .def_static("load", loadEnvironment, py::arg("path"), py::kw_only(),
                    py::arg("rotate") = 0.0, py::arg("gain") = 1.0,
                    py::arg("progress") = py::none(),
                    "Reads OpenEXR or Radiance HDR. rotate: as rotate() has it. gain: times the\n"
                    "map's radiance, a factor or linear RGB (3,), 0 to 1e6.")
        .def_static(
            "from_array", environmentOf, py::arg("texels"), py::kw_only(), py::arg("rotate") = 0.0,
            py::arg("progress") = py::none(),
            "Of a map in memory, (height, width, 3), linear radiance of at least 0. With x in\n"
            "(0, 1) from the left and y from the top, texels look to the longitude\n"
            "a = pi - 2 pi x and the latitude b = pi / 2 - pi y, which is the direction\n"
            "(cos b sin a, sin b, cos b cos a): a map that is mirrored turns the sun to the\n"
            "other side.")
        .def_static("constant", constantEnvironment, py::arg("radiance"),
                    "The same radiance from everywhere: a number, or linear RGB (3,).")
        .def("rotate", rotated, py::arg("degrees"), py::kw_only(), py::arg("progress") = py::none(),
             "The same light turned further: by degrees about +Y, counter-clockwise seen from\n"
             "above; by three, about +X, then +Y, then +Z; or by a matrix (3, 3) that takes\n"
             "directions to where they are to be, orthogonal, reflections included.")
        .def("tint", tinted, py::arg("gain"), py::kw_only(), py::arg("progress") = py::none(),
             "The same light times a factor, or linear RGB (3,), 0 to 1e6.")
        .def("integrate", integrate, py::kw_only(), py::arg("progress") = py::none(),
             py::arg("threads") = 0,
             "Integral of the radiance over all directions [radiance sr], (3,) float64.")
        .def("sample", sampleEnvironment, py::arg("count"), py::kw_only(), py::arg("seed") = 1,
             py::arg("progress") = py::none(), py::arg("threads") = 0,
             "Directions distributed as the luminance: (directions (count, 3), radiances\n"
             "(count, 3), densities (count,) [1/sr]), float32, of a scrambled Sobol' sequence.")
        .def("look_up", lookUp, py::arg("directions"), py::kw_only(),
             py::arg("progress") = py::none(), py::arg("threads") = 0,
             "Radiances (..., 3), and the densities [1/sr] (...) with which sample() draws them,\n"
             "along directions (..., 3) of any length, float32.")
        .def_property_readonly(
            "rotation", [](const EnvironmentObject& e) { return e.rotation; },
            "Degrees about +Y that it was turned by last, counter-clockwise seen from above.")
        .def_property_readonly(
            "turn", [](const EnvironmentObject& e) { return matrixOf(turnOf(e).whole()); },
            "Matrix that takes directions of the map to those of the world, (3, 3) float64.")
        .def_property_readonly(
            "notes", [](const EnvironmentObject& e) { return e.map->notes; },
            "What reading the map chose or mended, in lines for people.")
        .def(py::pickle(&stateOfEnvironment, &environmentOfState))
        .def("__repr__", [](const EnvironmentObject& e) { return reprOfEnvironment(e); });
}

}  // namespace shadowcache::python
