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
#include "common/base/text_streams.h"
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

/// Says what a set leaves out.
void warnOfMoving(const LoadedSet& set) {
    if (!set.shots) return;
    std::size_t moving = 0;
    for (const GltfShot& shot : *set.shots)
        moving += shot.movingNodes().size() + shot.movingLampNodes().size();
    const std::string text = std::to_string(moving) +
                             " nodes move and are left out; Scene.at_frame(N) has them where they "
                             "are in a frame, and frame=N loads them as a part of the set";
    if (PyErr_WarnEx(PyExc_UserWarning, text.c_str(), 1) != 0) throw py::error_already_set();
}

SceneObject loadScene(const py::object& set, const py::object& triangles, const py::object& colors,
                      const py::object& normals, const py::object& progress, int threads,
                      const py::kwargs& keywords) {
    RenderJob job;
    readKeywords("load_set", keywords, optionRows(Part::set, job));
    const MeshOptions options = meshOptionsOf(job.stage.set);
    const auto checked = [&](std::shared_ptr<const LoadedSet> loaded) {
        requireMatches(options.gains, namesForGains(*loaded));
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
    SceneObject scene{
        longCall(
            progress, [&] { return checked(loadSet(files, options, job.stage.set.fps)); }, threads),
        files};
    scene.options = py::dict(**keywords);
    warnOfMoving(*scene.set);
    return scene;
}

SceneObject atFrame(const SceneObject& scene, int frame, const py::object& progress, int threads) {
    requireNoFrame(*scene.set, "Scene.at_frame");
    SceneObject posed = scene;
    if (scene.set->shots)
        posed.set = longCall(
            progress,
            [frame, still = scene.set] {
                return std::shared_ptr<const LoadedSet>(setAt(*still, frame));
            },
            threads);
    return posed;
}

py::tuple stateOfScene(const SceneObject& scene) {
    py::list files;
    for (const fs::path& file : scene.files) files.append(pickledPath(file, "Scene"));
    if (scene.files.empty()) pickledPath({}, "Scene");
    return py::make_tuple(files, scene.options, scene.set->fingerprint, scene.lamps,
                          scene.set->frame);
}

SceneObject sceneOf(const py::tuple& state) {
    py::object scene =
        py::module_::import("shadowcache").attr("load_set")(state[0], **py::dict(state[1]));
    const auto& loaded = scene.cast<const SceneObject&>();
    requireUnchanged(loaded.set->fingerprint == state[2].cast<std::uint64_t>(),
                     loaded.files.front().string());
    if (py::len(state[3]) > 0) scene = scene.attr("with_lamps")(state[3]);
    if (!state[4].is_none()) scene = scene.attr("at_frame")(state[4]);
    return scene.cast<SceneObject>();
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

void requireNoFrame(const LoadedSet& set, const char* call) {
    if (set.frame)
        throw Error(
            fmt::format("{}: the scene is in frame {}, expected the one that at_frame() made it of",
                        call, *set.frame));
}

void defineScene(py::module_& module) {
    py::class_<SceneObject>(
        module, "Scene",
        "A set in memory, ready to be baked and rendered. Pickled by its files, with its Lamps\n"
        "and its frame.")
        .def_property_readonly(
            "triangles", [](const SceneObject& s) { return s.set->mesh.report.placed; },
            "Number of triangles in the world, each copy of an instance counted; without what\n"
            "moves.")
        .def_property_readonly(
            "bounds",
            [](const SceneObject& s) {
                const Box3d bounds = boundsOf(*s.set);
                return arrayOf<double>({2, 3}, std::vector<Vec3d>{bounds.min, bounds.max});
            },
            "Least and greatest corner in world space [m], (2, 3) float64; without what moves.")
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
        .def(
            "at_frame", atFrame, py::arg("frame"), py::kw_only(), py::arg("progress") = py::none(),
            py::arg("threads") = 0,
            "A Scene of the same set with the objects and lamps that glTF animations move, where\n"
            "they are in a frame, as shadowcache-render has them: render(), intersect() and\n"
            "occluded() see them. frame: any whole number; frame f is at f / fps seconds, by the\n"
            "fps of load_set(), and its camera is camera(name, frame=f).\n"
            "Its caches are those of the set without a frame: no cache counts what moves. The set\n"
            "is copied in memory. Where nothing moves, it is the same Scene.\n"
            "Raises Error for a Scene that is in a frame already. Such a one is refused by name\n"
            "by bake(), by with_lamps(), and by what a Cache predicts with scene=.")
        .def_property_readonly(
            "frame", [](const SceneObject& s) { return s.set->frame; },
            "That at_frame() put it in; None: what moves is left out.")
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
        "What glTF animations move is left out, with a warning, until Scene.at_frame() puts it "
        "in;\n"
        "with frame=N all stands still as it is in that frame, and is baked with the set.\n\n"
        "Options, with their standard values:\n" +
        helpOf(optionRows(Part::set, standard));
    module.def("load_set", loadScene, py::arg("set"), py::arg("triangles") = py::none(),
               py::kw_only(), py::arg("colors") = py::none(), py::arg("normals") = py::none(),
               py::arg("progress") = py::none(), py::arg("threads") = 0, kLoadHelp.c_str());
}

}  // namespace shadowcache::python
