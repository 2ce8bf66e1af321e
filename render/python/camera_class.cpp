#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "common/base/option_checks.h"
#include "common/base/text_streams.h"
#include "common/shot/camera_file.h"
#include "common/shot/camera_source.h"
#include "render/python/arrays.h"
#include "render/python/classes.h"
#include "render/python/long_call.h"

namespace shadowcache::python {

namespace py = pybind11;
namespace fs = std::filesystem;

namespace {

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

CameraMove cameraOf(const py::object& eye, const py::object& lookAt, std::optional<double> fov,
                    double lensRadius, std::optional<double> focus, int blades,
                    double bladeRotation, std::optional<double> height) {
    if (fov && height) throw py::value_error("fov cannot be combined with height");
    if (height && !(*height > 0 && *height < 1e9))
        throw py::value_error("height: expected metres above 0, below 1e9");
    CameraOptions options;
    options.eye = vectorOf(eye, "eye");
    options.lookAt = vectorOf(lookAt, "look_at");
    options.fovYDegrees = fov.value_or(options.fovYDegrees);
    requireRange("fov-y", options.fovYDegrees, 0.01, 179.0);
    Camera camera = CameraSource(options, {}).at(1);
    camera.height = height.value_or(0);
    camera.lens = {lensRadius, focus.value_or((*options.lookAt - *options.eye).length()), blades,
                   bladeRotation * kPi / 180};
    if (lensRadius != 0 || focus || blades != 0) requireLens(camera.lens);
    return camera;
}

std::string reprOfCamera(const CameraMove& move) {
    const Camera camera = move.middle();
    TextWriter text;
    text << "<shadowcache.Camera: at (" << camera.origin.x << ", " << camera.origin.y << ", "
         << camera.origin.z << "), along (" << camera.forward.x << ", " << camera.forward.y << ", "
         << camera.forward.z << "), ";
    if (camera.height > 0)
        text << "orthographic, " << camera.height << " m high";
    else
        text << camera.fovY * 180 / kPi << " degrees high";
    return text.str() + (move.moves ? ", moving>" : ">");
}

CameraMove moving(const CameraMove& opening, const CameraMove& closing) {
    between(opening.open, closing.close, 0.5);  // refuses what does not fit
    return {opening.open, closing.close};
}

/// A property of what it is in the middle of the exposure.
template <class Get>
auto inTheMiddle(const Get& get) {
    return [get](const CameraMove& move) { return get(move.middle()); };
}

py::array tripleOf(const Vec3d& v) {
    return arrayOf<double>({3}, std::vector{v});
}

}  // namespace

void defineCamera(py::module_& module) {
    py::class_<CameraMove>(module, "Camera", "A camera in world space.")
        .def(
            py::init(&cameraOf), py::arg("eye"), py::arg("look_at"), py::kw_only(),
            py::arg("fov") = py::none(), py::arg("lens_radius") = 0.0,
            py::arg("focus") = py::none(), py::arg("blades") = 0, py::arg("blade_rotation") = 0.0,
            py::arg("height") = py::none(),
            "eye, look_at: where it stands, and what is in the middle of the picture [m].\n"
            "fov: vertical angle of view [degrees]; None: 45.\n"
            "height: of what it sees, all along the view [m]: orthographic. None: in perspective.\n"
            "lens_radius: of the aperture [m]; 0: all is sharp. focus: distance along the view\n"
            "    of what is sharp [m]; None: that of look_at. blades: corners of the aperture;\n"
            "    0: it is round. blade_rotation: counter-clockwise as the camera looks [degrees].")
        .def_static(
            "load",
            [](const fs::path& path, int frame, double shutter) {
                CameraOptions options;
                options.name = path.string();
                options.shutter = shutter;
                return longCall(py::none(),
                                [&] { return CameraSource(options, {}).moveAt(frame); });
            },
            py::arg("path"), py::kw_only(), py::arg("frame") = 1, py::arg("shutter") = 0.0,
            "The camera of a frame of a camera file (.json). Scene.camera() has those of glTF.\n"
            "shutter: share of a frame's time that it moves in while the shutter is open, half\n"
            "before and half after the frame, 0 to 1.")
        .def_static(
            "moving", moving, py::arg("opening"), py::arg("closing"),
            "A camera that moves from one to another while the shutter is open: evenly, in\n"
            "place, angle and lens. What can be asked of it is that of the middle.")
        .def_property_readonly("origin",
                               inTheMiddle([](const Camera& c) { return tripleOf(c.origin); }),
                               "Where it stands [m], (3,) float64.")
        .def_property_readonly("forward",
                               inTheMiddle([](const Camera& c) { return tripleOf(c.forward); }),
                               "Along the view, unit, (3,) float64.")
        .def_property_readonly(
            "up", inTheMiddle([](const Camera& c) { return tripleOf(c.up); }),
            "Upwards in the picture, unit, at right angles to `forward`, (3,) float64.")
        .def_property_readonly("fov", inTheMiddle([](const Camera& c) {
                                   return c.height > 0 ? std::nullopt
                                                       : std::optional(c.fovY * 180 / kPi);
                               }),
                               "Vertical angle of view [degrees]; None: orthographic.")
        .def_property_readonly("height", inTheMiddle([](const Camera& c) {
                                   return c.height > 0 ? std::optional(c.height) : std::nullopt;
                               }),
                               "Of what it sees [m]; None: in perspective.")
        .def_property_readonly("lens_radius",
                               inTheMiddle([](const Camera& c) { return c.lens.radius; }),
                               "Of the aperture [m]; 0: all is sharp.")
        .def("__repr__", reprOfCamera);
}

}  // namespace shadowcache::python
