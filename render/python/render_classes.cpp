#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/base/error.h"
#include "common/base/option_checks.h"
#include "common/base/parallel.h"
#include "common/base/text_streams.h"
#include "common/image/exr.h"
#include "common/image/radiance.h"
#include "common/predict/places.h"
#include "common/random/sequence.h"
#include "common/shot/camera_file.h"
#include "common/shot/camera_source.h"
#include "render/frame/aov_channels.h"
#include "render/library/cache_of_set.h"
#include "render/library/lit_stage.h"
#include "render/library/option_table.h"
#include "render/library/picture_options.h"
#include "render/python/arrays.h"
#include "render/python/classes.h"
#include "render/python/long_call.h"
#include "render/python/options.h"

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
        return lit(path.string(), std::make_shared<const RadianceImage>(readRadiance(path)),
                   rotate);
    });
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

std::string reprOf(const EnvironmentObject& environment) {
    TextWriter text;
    text << "<shadowcache.Environment: " << environment.name << ", " << environment.map->image.width
         << " x " << environment.map->image.height << ", rotated by " << environment.rotation
         << " degrees>";
    return text.str();
}

/// @throws ValueError
void requireLens(const Lens& lens) {
    if (!(lens.radius >= 0 && lens.radius < 1e9))
        throw py::value_error("lens_radius: expected metres of at least 0, below 1e9");
    if (!(lens.focus > 0 && lens.focus < 1e9))
        throw py::value_error("focus: expected metres above 0, below 1e9");
    if (lens.blades != 0 && (lens.blades < 3 || lens.blades > kMostBlades))
        throw py::value_error("blades: expected 3 to " + std::to_string(kMostBlades) +
                              ", or 0 for a round aperture");
    if (!std::isfinite(lens.rotation))
        throw py::value_error("blade_rotation: expected a finite number of degrees");
}

Camera cameraOf(const py::object& eye, const py::object& lookAt, double fov, double lensRadius,
                std::optional<double> focus, int blades, double bladeRotation) {
    CameraOptions options;
    options.eye = vectorOf(eye, "eye");
    options.lookAt = vectorOf(lookAt, "look_at");
    options.fovYDegrees = fov;
    requireRange("fov-y", fov, 0.01, 179.0);
    Camera camera = CameraSource(options, {}).at(1);
    camera.lens = {lensRadius, focus.value_or((*options.lookAt - *options.eye).length()), blades,
                   bladeRotation * kPi / 180};
    if (lensRadius != 0 || focus || blades != 0) requireLens(camera.lens);
    return camera;
}

std::string reprOf(const Camera& camera) {
    TextWriter text;
    text << "<shadowcache.Camera: at (" << camera.origin.x << ", " << camera.origin.y << ", "
         << camera.origin.z << "), along (" << camera.forward.x << ", " << camera.forward.y << ", "
         << camera.forward.z << "), ";
    if (camera.height > 0)
        text << "orthographic, " << camera.height << " m high>";
    else
        text << camera.fovY * 180 / kPi << " degrees high>";
    return text.str();
}

/// The channels of one name.
struct Layer {
    std::string name;
    std::vector<const Channel*> parts;
};

/// Channels by the names before their last dots, in the order of their letters' meaning.
std::vector<Layer> layersOf(const std::vector<Channel>& channels) {
    std::vector<Layer> layers;
    for (const Channel& channel : channels) {
        const std::size_t dot = channel.name.rfind('.');
        const std::string name = dot == std::string::npos ? "color" : channel.name.substr(0, dot);
        auto found = std::ranges::find(layers, name, &Layer::name);
        if (found == layers.end()) found = layers.insert(found, {name, {}});
        found->parts.push_back(&channel);
    }
    const auto rank = [](const Channel* channel) {
        return std::string("RGBAXYZ").find(channel->name.back());
    };
    for (Layer& layer : layers) std::ranges::sort(layer.parts, {}, rank);
    return layers;
}

py::dict picturesOf(const std::vector<Channel>& channels, int width, int height) {
    py::dict pictures;
    for (const Layer& layer : layersOf(channels)) {
        const std::size_t count = layer.parts.size();
        std::vector<float> values(layer.parts.front()->values.size() * count);
        for (std::size_t k = 0; k < count; ++k)
            for (std::size_t i = 0; i < layer.parts[k]->values.size(); ++i)
                values[i * count + k] = layer.parts[k]->values[i];
        Shape shape{height, width};
        if (count > 1) shape.push_back(static_cast<py::ssize_t>(count));
        pictures[py::str(layer.name)] = arrayOf<float>(shape, std::move(values));
    }
    return pictures;
}

py::dict readPicture(const fs::path& path) {
    const ExrFile file = longCall(py::none(), [&] { return readExr(path); });
    return picturesOf(file.channels, file.width, file.height);
}

/// The options of render(), written to a job.
std::vector<OptionRow> pictureRows(RenderJob& job) {
    std::vector<OptionRow> rows = optionRows(Part::size, job);
    for (const Part part : {Part::picture, Part::cache})
        for (const OptionRow& row : optionRows(part, job))
            if (part == Part::picture || row.name == "stale-ok") rows.push_back(row);
    return rows;
}

/// What is said of a picture, for people. To be called with the interpreter's lock.
void warn(const std::vector<std::string>& notes) {
    for (const std::string& note : notes)
        if (PyErr_WarnEx(PyExc_UserWarning, note.c_str(), 1) != 0) throw py::error_already_set();
}

/// The picture's channels. To be called without the interpreter's lock.
std::vector<Channel> renderChannels(const LoadedSet& set, const ShadowCache* cache,
                                    const Environment& environment, const Camera& camera, int frame,
                                    const PictureOptions& asked, std::vector<std::string>& notes) {
    const PictureSettings settings = resolve(asked, cache != nullptr, set.options.gloss);
    LitStage lit(set.scene, cache, settings.estimator, lightingOf(asked, settings));
    lit.requirePrediction(settings.options);
    if (!lit.note().empty()) notes.push_back(lit.note());
    lit.setEnvironment(environment);
    RenderStats stats;
    const Picture picture =
        lit.plan(camera, frame, settings.options, stats, asked.rays.targetError.value_or(0));
    return channels(picture.film(stats), asked.aovs);
}

py::dict renderScene(const SceneObject& scene, const std::shared_ptr<CacheObject>& cache,
                     const EnvironmentObject& environment, const Camera& camera, int frame,
                     const py::object& progress, int threads, const py::kwargs& options) {
    RenderJob job;
    readKeywords("render", options, pictureRows(job));
    const auto set = scene.set;
    const auto light = environment.light;
    const auto kept = cache ? cache->cache : nullptr;
    std::vector<std::string> notes;
    if (kept)
        isStale(kept->header(), set->fingerprint, "cache", job.stage.staleOk,
                [&](const std::string& text, NoteKind) { notes.push_back(text); });
    const std::vector<Channel> all = longCall(
        progress,
        [&] { return renderChannels(*set, kept.get(), *light, camera, frame, job.picture, notes); },
        threads);
    warn(notes);
    const FilmRectangle region = job.picture.options.region();
    return picturesOf(all, region.width, region.height);
}

}  // namespace

void defineEnvironment(py::module_& module) {
    py::class_<EnvironmentObject, std::shared_ptr<EnvironmentObject>>(
        module, "Environment",
        "Distant light from a lat-long map: row 0 is +Y, the middle looks to +Z.")
        .def_static("load", loadEnvironment, py::arg("path"), py::kw_only(),
                    py::arg("rotate") = 0.0, py::arg("progress") = py::none(),
                    "Reads OpenEXR or Radiance HDR. rotate: degrees about +Y, counter-clockwise\n"
                    "seen from above.")
        .def_static("from_array", environmentOf, py::arg("texels"), py::kw_only(),
                    py::arg("rotate") = 0.0, py::arg("progress") = py::none(),
                    "Of a map in memory, (height, width, 3), linear radiance of at least 0.")
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
        .def("__repr__", [](const EnvironmentObject& e) { return reprOf(e); });
}

void defineRender(py::module_& module) {
    py::class_<Camera>(module, "Camera", "A camera in world space.")
        .def(py::init(&cameraOf), py::arg("eye"), py::arg("look_at"), py::kw_only(),
             py::arg("fov") = 45.0, py::arg("lens_radius") = 0.0, py::arg("focus") = py::none(),
             py::arg("blades") = 0, py::arg("blade_rotation") = 0.0,
             "eye, look_at: where it stands, and what is in the middle of the picture [m].\n"
             "fov: vertical angle of view [degrees].\n"
             "lens_radius: of the aperture [m]; 0: all is sharp. focus: distance along the view\n"
             "    of what is sharp [m]; None: that of look_at. blades: corners of the aperture;\n"
             "    0: it is round. blade_rotation: counter-clockwise as the camera looks [degrees].")
        .def_static(
            "load",
            [](const fs::path& path, int frame) {
                return CameraSource({path.string(), {}, {}}, {}).at(frame);
            },
            py::arg("path"), py::kw_only(), py::arg("frame") = 1,
            "The camera of a frame of a camera file (.json). Scene.camera() has those of glTF.")
        .def_property_readonly(
            "origin", [](const Camera& c) { return arrayOf<double>({3}, std::vector{c.origin}); },
            "Where it stands [m], (3,) float64.")
        .def_property_readonly(
            "forward", [](const Camera& c) { return arrayOf<double>({3}, std::vector{c.forward}); },
            "Along the view, unit, (3,) float64.")
        .def_property_readonly(
            "up", [](const Camera& c) { return arrayOf<double>({3}, std::vector{c.up}); },
            "Upwards in the picture, unit, at right angles to `forward`, (3,) float64.")
        .def_property_readonly(
            "fov",
            [](const Camera& c) {
                return c.height > 0 ? std::nullopt : std::optional(c.fovY * 180 / kPi);
            },
            "Vertical angle of view [degrees]; None: orthographic.")
        .def_property_readonly(
            "lens_radius", [](const Camera& c) { return c.lens.radius; },
            "Of the aperture [m]; 0: all is sharp.")
        .def("__repr__", [](const Camera& camera) { return reprOf(camera); });
    RenderJob standard;
    static const std::string kRenderHelp =
        "Renders a Scene as a Camera sees it: the pixels of shadowcache-render.\n\n"
        "cache: of the scene; None: rendered without one. frame: number of the frame, which\n"
        "    chooses its random numbers with the seed.\n"
        "Returns a dict of float32 arrays: 'color' (height, width, 3), linear radiance, with\n"
        "transparent=True (height, width, 4), and each of the aovs, (height, width, 3) or\n"
        "(height, width).\n\n"
        "Options, with their standard values:\n" +
        helpOf(pictureRows(standard));
    module.def("render", renderScene, py::arg("scene"), py::arg("cache").none(true),
               py::arg("environment"), py::arg("camera"), py::kw_only(), py::arg("frame") = 1,
               py::arg("progress") = py::none(), py::arg("threads") = 0, kRenderHelp.c_str());
    module.def("read_exr", readPicture, py::arg("path"),
               "The pictures of an EXR file of shadowcache-render, named as render() names them.");
}

}  // namespace shadowcache::python
