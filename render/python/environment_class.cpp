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
#include "common/predict/places.h"
#include "common/random/sequence.h"
#include "render/python/arrays.h"
#include "render/python/classes.h"
#include "render/python/long_call.h"

namespace shadowcache::python {

namespace py = pybind11;
namespace fs = std::filesystem;

namespace {

/// Lights a map's tables by a rotation. To be called without the interpreter's lock, as lit().
std::shared_ptr<EnvironmentObject> turned(EnvironmentObject object, double rotation) {
    object.rotation = rotation;
    object.light =
        std::make_shared<const Environment>(object.tables, turnByAngles({0, rotation, 0}));
    return std::make_shared<EnvironmentObject>(std::move(object));
}

/// Makes a map's tables and lights them by a rotation.
std::shared_ptr<EnvironmentObject> lit(const std::string& name,
                                       std::shared_ptr<const RadianceImage> map, double rotation) {
    auto tables = std::make_shared<const EnvironmentMap>(map->image, map->luminanceWeights);
    return turned({name, std::move(map), std::move(tables), 0, nullptr}, rotation);
}

void requireRotation(double rotation) {
    if (!std::isfinite(rotation))
        throw py::value_error("rotate: expected a finite number of degrees");
}

std::shared_ptr<EnvironmentObject> loadEnvironment(const fs::path& path, double rotate,
                                                   const py::object& progress) {
    requireRotation(rotate);
    return longCall(progress, [&] {
        auto environment =
            lit(path.string(), std::make_shared<const RadianceImage>(readRadiance(path)), rotate);
        environment->path = path;
        return environment;
    });
}

py::tuple stateOfEnvironment(const EnvironmentObject& environment) {
    return py::make_tuple(pickledPath(environment.path, "Environment"), environment.rotation,
                          environment.light->luminanceIntegral());
}

std::shared_ptr<EnvironmentObject> environmentOfState(const py::tuple& state) {
    const auto path = state[0].cast<std::string>();
    auto environment = loadEnvironment(path, state[1].cast<double>(), py::none());
    requireUnchanged(environment->light->luminanceIntegral() == state[2].cast<double>(), path);
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

std::shared_ptr<EnvironmentObject> environmentOf(const py::object& texels, double rotate,
                                                 const py::object& progress) {
    requireRotation(rotate);
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
        return lit("array", std::make_shared<const RadianceImage>(std::move(map)), rotate);
    });
}

std::shared_ptr<EnvironmentObject> constantEnvironment(const py::object& radiance) {
    RadianceImage map;
    map.image = {1, 1, {radianceOf(colorOf(radiance, "radiance"), "radiance")}};
    return longCall(py::none(), [&] {
        return lit("constant", std::make_shared<const RadianceImage>(std::move(map)), 0);
    });
}

std::shared_ptr<EnvironmentObject> rotated(const EnvironmentObject& environment, double degrees,
                                           const py::object& progress) {
    requireRotation(degrees);
    const EnvironmentObject copy = environment;
    return longCall(progress, [&] { return turned(copy, copy.rotation + degrees); });
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
                    py::arg("rotate") = 0.0, py::arg("progress") = py::none(),
                    "Reads OpenEXR or Radiance HDR. rotate: degrees about +Y, counter-clockwise\n"
                    "seen from above.")
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
             "The same light turned further about +Y, counter-clockwise seen from above.")
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
            "Degrees about +Y, counter-clockwise seen from above.")
        .def_property_readonly(
            "notes", [](const EnvironmentObject& e) { return e.map->notes; },
            "What reading the map chose or mended, in lines for people.")
        .def(py::pickle(&stateOfEnvironment, &environmentOfState))
        .def("__repr__", [](const EnvironmentObject& e) { return reprOfEnvironment(e); });
}

}  // namespace shadowcache::python
