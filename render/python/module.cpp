#include <fmt/core.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <cmath>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "common/base/error.h"
#include "common/base/interrupt.h"
#include "common/base/option_checks.h"
#include "common/base/parallel.h"
#include "common/base/text_streams.h"
#include "common/base/version.h"
#include "common/import/lamp_gain.h"
#include "common/mesh/placed_mesh.h"
#include "common/shot/camera_source.h"
#include "common/shot/gltf_shot.h"
#include "render/library/option_table.h"
#include "render/python/arrays.h"
#include "render/python/classes.h"
#include "render/python/long_call.h"
#include "render/python/options.h"

namespace shadowcache::python {

namespace py = pybind11;
namespace fs = std::filesystem;

namespace {

constexpr const char* kModuleDoc =
    "Bakes the visibility of a static set once, and renders it under any HDRI.\n\n"
    "    scene = shadowcache.load_set('room.glb')\n"
    "    cache = shadowcache.bake(scene)\n"
    "    sky = shadowcache.Environment.load('sky.exr')\n"
    "    camera = shadowcache.Camera(eye=(2, 1.6, 3), look_at=(0, 1, 0))\n"
    "    color = shadowcache.render(scene, cache, sky, camera)['color']\n\n"
    "World space is right-handed with +Y up, in metres. Radiance is linear; irradiance is\n"
    "radiance times steradians. Arrays of places and directions have a last axis of 3, of any\n"
    "real dtype, and are broadcast against each other. Long calls let other threads run, take\n"
    "progress=f, called as f(task, done, total), and threads=N, the threads to work on at most\n"
    "(0: those of set_threads()), and end on Ctrl-C. Refused inputs raise Error, or ValueError\n"
    "and TypeError for arrays.";

bool isPath(const py::handle& value) {
    return py::isinstance<py::str>(value) || py::hasattr(value, "__fspath__");
}

/// Set files as a path, or several.
std::vector<fs::path> pathsOf(const py::object& set) {
    if (isPath(set)) return {set.cast<fs::path>()};
    std::vector<fs::path> files;
    for (const py::handle file : set) {
        if (!isPath(file)) throw py::type_error("set: expected the paths of files");
        files.push_back(file.cast<fs::path>());
    }
    return files;
}

bool namesFiles(const py::object& set) {
    if (py::isinstance<py::list>(set) || py::isinstance<py::tuple>(set))
        return py::len(set) > 0 && isPath(*set.begin());
    return isPath(set);
}

/// An array (n, 3).
Doubles rowsOf(const py::object& value, const char* name) {
    Doubles array = vectorsOf(value, name);
    if (array.ndim() != 2)
        throw py::value_error(std::string(name) + ": shape " + shapeText(array) +
                              ", expected (n, 3)");
    return array;
}

/// One row for each vertex; without rows of none.
std::optional<Doubles> rowsOfVertices(const py::object& value, const char* name,
                                      std::size_t vertices) {
    if (value.is_none()) return std::nullopt;
    Doubles array = rowsOf(value, name);
    if (vectorsIn(array).size() != vertices)
        throw py::value_error(std::string(name) + ": shape " + shapeText(array) + ", expected (" +
                              std::to_string(vertices) + ", 3), a row for each vertex");
    return array;
}

/// The arrays of a set, as doubles.
struct SetArrays {
    Doubles vertices, triangles;
    std::optional<Doubles> colors, normals;
};

SetArrays arraysOf(const py::object& vertices, const py::object& triangles,
                   const py::object& colors, const py::object& normals) {
    Doubles places = rowsOf(vertices, "vertices");
    const char kind = numbersOf(triangles, "triangles").dtype().kind();
    if (kind != 'i' && kind != 'u')
        throw py::type_error("triangles: expected an array of integers, three corners each");
    const std::size_t count = vectorsIn(places).size();
    if (count == 0) throw py::value_error("vertices: shape (0, 3), expected some");
    return {std::move(places), rowsOf(triangles, "triangles"),
            rowsOfVertices(colors, "colors", count), rowsOfVertices(normals, "normals", count)};
}

/// Rows between two polls for Ctrl-C.
constexpr std::size_t kPolled = std::size_t{1} << 20;

/// Calls `take` with each row's number and its values. @throws Interrupted
template <class Take>
void forEachRow(const Doubles& rows, const Take& take) {
    const std::span<const Vec3d> all = vectorsIn(rows);
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (i % kPolled == 0) throwIfInterrupted();
        take(i, all[i]);
    }
}

void requireFinite(const char* name, std::size_t row, const Vec3d& v) {
    if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z))
        throw py::value_error(std::string(name) + "[" + std::to_string(row) +
                              "]: expected finite numbers");
}

/// Needs no lock.
RawMesh meshOf(const SetArrays& arrays) {
    RawMesh raw;
    const std::size_t count = vectorsIn(arrays.vertices).size();
    raw.vertices.reserve(count);
    forEachRow(arrays.vertices, [&](std::size_t row, const Vec3d& place) {
        requireFinite("vertices", row, place);
        raw.vertices.push_back(place);
    });
    raw.faceVertices.reserve(3 * vectorsIn(arrays.triangles).size());
    forEachRow(arrays.triangles, [&](std::size_t row, const Vec3d& corners) {
        for (int k = 0; k < 3; ++k) {
            if (!(corners[k] >= 0 && corners[k] < static_cast<double>(count)))
                throw py::value_error(fmt::format(
                    "triangles[{}]: vertex {:.0f}, expected 0 to {} - 1", row, corners[k], count));
            raw.faceVertices.push_back(static_cast<std::uint32_t>(corners[k]));
        }
    });
    raw.faceSizes.assign(vectorsIn(arrays.triangles).size(), 3);
    if (arrays.colors)
        forEachRow(*arrays.colors, [&](std::size_t, const Vec3d& color) {
            for (int k = 0; k < 3; ++k)
                if (!(color[k] >= 0 && color[k] <= 1))
                    throw py::value_error("colors: expected linear albedos, 0 to 1");
            raw.colors.emplace_back(color);
        });
    if (arrays.normals)
        forEachRow(*arrays.normals, [&](std::size_t row, const Vec3d& normal) {
            requireFinite("normals", row, normal);
            raw.normals.push_back(normal);
        });
    return raw;
}

/// Says what a set that stands still leaves out.
void warnOfMoving(const std::vector<fs::path>& files, const MeshOptions& options, double fps) {
    if (options.stillAt) return;
    std::size_t moving = 0;
    for (const GltfShot& shot : openShots(files, options, fps))
        moving += shot.movingNodes().size() + shot.movingLampNodes().size();
    if (moving == 0) return;
    const std::string text = std::to_string(moving) +
                             " nodes move and are left out; frame=N loads them as they stand then";
    if (PyErr_WarnEx(PyExc_UserWarning, text.c_str(), 1) != 0) throw py::error_already_set();
}

SceneObject loadScene(const py::object& set, const py::object& triangles, const py::object& colors,
                      const py::object& normals, const py::object& progress, int threads,
                      const py::kwargs& keywords) {
    RenderJob job;
    readKeywords("load_set", keywords, optionRows(Part::set, job));
    const MeshOptions options = meshOptionsOf(job.stage.set);
    const auto checked = [&](std::shared_ptr<const LoadedSet> loaded) {
        requireMatches(options.gains, loaded->mesh);
        return loaded;
    };
    if (!namesFiles(set)) {
        const SetArrays arrays = arraysOf(set, triangles, colors, normals);
        return {longCall(
                    progress, [&] { return checked(makeSet("set", meshOf(arrays), options)); },
                    threads),
                {}};
    }
    if (!triangles.is_none() || !colors.is_none() || !normals.is_none())
        throw py::type_error("load_set: expected files, or arrays, not both");
    const std::vector<fs::path> files = pathsOf(set);
    SceneObject scene{longCall(
                          progress, [&] { return checked(loadSet(files, options)); }, threads),
                      files};
    scene.options = py::dict(**keywords);
    warnOfMoving(files, options, job.stage.set.fps);
    return scene;
}

py::tuple stateOfScene(const SceneObject& scene) {
    py::list files;
    for (const fs::path& file : scene.files) files.append(pickledPath(file, "Scene"));
    if (scene.files.empty()) pickledPath({}, "Scene");
    if (scene.hasLampsOfArrays)
        throw Error(
            "Scene: has lamps of arrays, by which it is not pickled; pickle it without, "
            "and call with_lamps() anew in each process");
    return py::make_tuple(files, scene.options, scene.set->fingerprint);
}

SceneObject sceneOf(const py::tuple& state) {
    const auto scene = py::module_::import("shadowcache")
                           .attr("load_set")(state[0], **py::dict(state[1]))
                           .cast<SceneObject>();
    requireUnchanged(scene.set->fingerprint == state[2].cast<std::uint64_t>(),
                     scene.files.front().string());
    return scene;
}

Box3d boundsOf(const LoadedSet& set) {
    Box3d bounds = placedBounds(set.mesh);
    bounds.min += set.mesh.origin;
    bounds.max += set.mesh.origin;
    return bounds;
}

std::string reprOfScene(const SceneObject& scene) {
    const Vec3d size = boundsOf(*scene.set).size();
    TextWriter text;
    text << "<shadowcache.Scene: " << scene.set->mesh.report.placed << " triangles, " << size.x
         << " x " << size.y << " x " << size.z << " m>";
    return text.str();
}

}  // namespace

std::string pickledPath(const fs::path& path, const char* what) {
    if (path.empty())
        throw Error(std::string(what) +
                    ": of no file, by whose path it would be pickled; save it and open that, or "
                    "make it anew in each process");
    return fs::absolute(path).string();
}

void requireUnchanged(bool same, const std::string& path) {
    if (!same) throwFileError(path, "has changed since the object was pickled");
}

void defineScene(py::module_& module) {
    py::class_<SceneObject>(
        module, "Scene", "A set in memory, ready to be baked and rendered. Pickled by its files.")
        .def_property_readonly(
            "triangles", [](const SceneObject& s) { return s.set->mesh.report.placed; },
            "Number of triangles in the world, each copy of an instance counted.")
        .def_property_readonly(
            "bounds",
            [](const SceneObject& s) {
                const Box3d bounds = boundsOf(*s.set);
                return arrayOf<double>({2, 3}, std::vector<Vec3d>{bounds.min, bounds.max});
            },
            "Least and greatest corner in world space [m], (2, 3) float64.")
        .def_property_readonly(
            "report", [](const SceneObject& s) { return describe(s.set->mesh.report); },
            "What loading found and mended, in one line.")
        .def(
            "camera",
            [](const SceneObject& s, const std::string& name, int frame, double fps,
               double shutter) {
                CameraOptions options;
                options.name = name;
                options.shutter = shutter;
                return longCall(py::none(), [&, set = s.set, files = s.files] {
                    const std::vector<GltfShot> shots = openShots(files, set->options, fps);
                    return CameraSource(options, shots).moveAt(frame);
                });
            },
            py::arg("name"), py::kw_only(), py::arg("frame") = 1, py::arg("fps") = 24.0,
            py::arg("shutter") = 0.0,
            "The Camera of a frame: one of the set's glTF cameras by its name, or a camera file\n"
            "(.json). shutter: as of Camera.load().")
        .def(py::pickle(&stateOfScene, &sceneOf))
        .def("__repr__", reprOfScene);
    RenderJob standard;
    static const std::string kLoadHelp =
        "Loads a set, and returns its Scene.\n\n"
        "set: a file, or several that make one set (OBJ, PLY, STL, OFF, OM, glTF); or the\n"
        "    vertices of triangles, (n, 3).\n"
        "triangles: with vertices, three of their numbers each, (m, 3) integers.\n"
        "colors: linear albedo of each vertex, (n, 3) in [0, 1]; without, what render()\n"
        "    takes for all.\n"
        "normals: shading normal of each vertex, (n, 3).\n"
        "Without frame=, what moves is left out, with a warning.\n\n"
        "Options, with their standard values:\n" +
        helpOf(optionRows(Part::set, standard));
    module.def("load_set", loadScene, py::arg("set"), py::arg("triangles") = py::none(),
               py::kw_only(), py::arg("colors") = py::none(), py::arg("normals") = py::none(),
               py::arg("progress") = py::none(), py::arg("threads") = 0, kLoadHelp.c_str());
}

}  // namespace shadowcache::python

/// What is in the module.
static void define(pybind11::module_& module) {
    namespace py = pybind11;
    module.doc() = shadowcache::python::kModuleDoc;
    module.attr("__version__") = shadowcache::kVersion;
    static auto& error = *new py::exception<shadowcache::Error>(
        module, "Error", PyExc_RuntimeError);  // outlives Python
    error.doc() =
        "An input or a file that is refused; the text names it, what was found and expected.";
    py::register_exception_translator([](std::exception_ptr thrown) {
        try {
            std::rethrow_exception(std::move(thrown));
        } catch (const shadowcache::Error& e) {
            error(shadowcache::python::inPythonsWords(e.what()).c_str());
        } catch (const std::filesystem::filesystem_error& e) {  // as the size of a device
            error((e.path1().string() + ": " + e.code().message()).c_str());
        }
    });
    module.def(
        "set_threads",
        [](int threads) {
            shadowcache::requireRange("threads", threads, 0, shadowcache::kMaxThreads);
            shadowcache::setThreadCount(threads);
        },
        py::arg("threads"), "Limits all later calls together to so many threads; 0: every core.");
    shadowcache::python::defineCamera(module);
    shadowcache::python::defineScene(module);
    shadowcache::python::defineRays(module);
    shadowcache::python::defineLamps(module);
    shadowcache::python::defineCache(module);
    shadowcache::python::defineEnvironment(module);
    shadowcache::python::defineIrradiance(module);
    shadowcache::python::defineSampler(module);
    shadowcache::python::defineRender(module);
}

/// As PYBIND11_MODULE, which waits for ever where the first import is another interpreter's:
/// pybind11 2.10 asks for the main interpreter's lock then, with its own held.
// NOLINTNEXTLINE(readability-identifier-naming): the name that Python wants
extern "C" PYBIND11_EXPORT PyObject* PyInit_shadowcache() {
    if (PyInterpreterState_Get() != PyInterpreterState_Main()) {
        PyErr_SetString(
            PyExc_ImportError,
            "shadowcache: a sub-interpreter cannot import it; use a process (multiprocessing)");
        return nullptr;
    }
    PYBIND11_CHECK_PYTHON_VERSION
    PYBIND11_ENSURE_INTERNALS_READY
    static pybind11::module_::module_def definition;
    auto module = pybind11::module_::create_extension_module("shadowcache", nullptr, &definition);
    try {
        define(module);
        return module.ptr();
    }
    PYBIND11_CATCH_INIT_EXCEPTIONS
}
