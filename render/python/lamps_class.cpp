#include <pybind11/stl.h>

#include <cmath>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "common/base/error.h"
#include "common/import/lamp_place.h"
#include "common/math/limits.h"
#include "common/predict/places.h"
#include "render/python/arrays.h"
#include "render/python/classes.h"
#include "render/python/long_call.h"

namespace shadowcache::python {

namespace py = pybind11;

namespace {

/// Numbers, each as a vector of three alike, so that they are broadcast as the others.
py::object tripled(const py::object& value, const char* name) {
    const py::array numbers = numbersOf(value, name);
    const py::module_ numpy = py::module_::import("numpy");
    return numpy.attr("broadcast_to")(numpy.attr("expand_dims")(numbers, -1),
                                      py::object(numbers.attr("shape")) + py::make_tuple(3));
}

/// Colours; one number is all three.
py::object colors(const py::object& value, const char* name) {
    const py::array numbers = numbersOf(value, name);
    return numbers.ndim() == 0 ? tripled(numbers, name) : py::object(numbers);
}

/// What the lamps of a call have in common.
struct AllOfThem {
    bool camera;  ///< sees them
    const std::string& name;
};

/// One lamp for each vector of the arguments: `make(i, vectors)`.
template <class Make>
LampsObject lampsOf(const Broadcast& all, const AllOfThem& common, const Make& make) {
    LampsObject made;
    std::vector<std::vector<Vec3d>> vectors(all.arguments());
    for (std::size_t k = 0; k < vectors.size(); ++k) {
        vectors[k].resize(all.size());
        all.read(k, 0, vectors[k]);
    }
    for (std::size_t i = 0; i < all.size(); ++i) {
        made.lamps.push_back(make(i, vectors));
        made.lamps.back().seenByCamera = common.camera;
        made.lamps.back().name = common.name;
    }
    return made;
}

[[noreturn]] void refuse(const char* name, std::size_t number, const char* expected) {
    throw py::value_error(std::string(name) + "[" + std::to_string(number) + "]: expected " +
                          expected);
}

Vec3d placeOf(const Vec3d& v, const char* name, std::size_t i) {
    if (!isInReach(v)) refuse(name, i, "finite numbers up to 1e12");
    return v;
}

Vec3d directionOf(const Vec3d& v, const char* name, std::size_t i) {
    if (!isDirection(v)) refuse(name, i, "a finite vector other than 0");
    return unitAlong(v);
}

Rgb strengthOf(const Vec3d& v, const char* name, std::size_t i, double times = 1) {
    for (int k = 0; k < 3; ++k)
        if (!(v[k] >= 0 && v[k] * times <= kMostLampStrength)) refuse(name, i, "0 to 1e15");
    return Rgb(v * times);
}

double within(double value, double most, const char* name, std::size_t i, const char* expected) {
    if (!(value >= 0 && value <= most)) refuse(name, i, expected);
    return value;
}

constexpr const char* kRadii = "metres, 0 to 1e9";

LampsObject points(const py::object& positions, const py::object& intensity,
                   const py::object& radius, bool camera, const std::string& name) {
    const py::object strengths = colors(intensity, "intensity"), radii = tripled(radius, "radius");
    const Broadcast all({{"positions", positions}, {"intensity", strengths}, {"radius", radii}});
    return lampsOf(all, {camera, name}, [](std::size_t i, const auto& v) {
        Lamp lamp;
        lamp.position = placeOf(v[0][i], "positions", i);
        lamp.strength = strengthOf(v[1][i], "intensity", i);
        lamp.radius = within(v[2][i].x, 1e9, "radius", i, kRadii);
        return lamp;
    });
}

LampsObject spots(const py::object& positions, const py::object& directions,
                  const py::object& intensity, const py::object& inner, const py::object& outer,
                  const py::object& radius, bool camera, const std::string& name) {
    const py::object strengths = colors(intensity, "intensity"), radii = tripled(radius, "radius"),
                     from = tripled(inner, "inner"), to = tripled(outer, "outer");
    const Broadcast all({{"positions", positions},
                         {"directions", directions},
                         {"intensity", strengths},
                         {"inner", from},
                         {"outer", to},
                         {"radius", radii}});
    return lampsOf(all, {camera, name}, [](std::size_t i, const auto& v) {
        Lamp lamp;
        lamp.position = placeOf(v[0][i], "positions", i);
        lamp.direction = directionOf(v[1][i], "directions", i);
        lamp.strength = strengthOf(v[2][i], "intensity", i);
        const double most = within(v[4][i].x, 90, "outer", i, "degrees, 0 to 90");
        const double least = within(v[3][i].x, most, "inner", i, "degrees, 0 to those of outer");
        lamp.cone = LampCone{.cosInner = std::cos(least * kPi / 180),
                             .cosOuter = std::cos(most * kPi / 180)};
        lamp.radius = within(v[5][i].x, 1e9, "radius", i, kRadii);
        return lamp;
    });
}

LampsObject suns(const py::object& directions, const py::object& irradiance,
                 const py::object& angle, bool camera, const std::string& name) {
    const py::object strengths = colors(irradiance, "irradiance"), angles = tripled(angle, "angle");
    const Broadcast all({{"directions", directions}, {"irradiance", strengths}, {"angle", angles}});
    return lampsOf(all, {camera, name}, [](std::size_t i, const auto& v) {
        Lamp lamp;
        lamp.form = Lamp::Form::sun;
        lamp.direction = directionOf(v[0][i], "directions", i);
        lamp.strength = strengthOf(v[1][i], "irradiance", i);
        lamp.angle = within(v[2][i].x, 180, "angle", i, "degrees, 0 to 180") * kPi / 180;
        return lamp;
    });
}

LampsObject areas(const py::object& positions, const py::object& widths, const py::object& heights,
                  const py::object& radiance, const std::string& shape, const py::object& spread,
                  bool camera, const std::string& name) {
    if (shape != "rectangle" && shape != "ellipse")
        throw py::value_error("shape: '" + shape + "', expected 'rectangle' or 'ellipse'");
    const bool isRound = shape == "ellipse";
    const py::object strengths = colors(radiance, "radiance"), spreads = tripled(spread, "spread");
    const Broadcast all({{"positions", positions},
                         {"widths", widths},
                         {"heights", heights},
                         {"radiance", strengths},
                         {"spread", spreads}});
    return lampsOf(all, {camera, name}, [isRound](std::size_t i, const auto& v) {
        Lamp lamp;
        lamp.form = isRound ? Lamp::Form::ellipse : Lamp::Form::rectangle;
        lamp.position = placeOf(v[0][i], "positions", i);
        lamp.halfWidth = placeOf(v[1][i], "widths", i) * 0.5;
        lamp.halfHeight = placeOf(v[2][i], "heights", i) * 0.5;
        const Vec3d across = v[1][i].cross(v[2][i]);
        if (!(across.length() > 0)) refuse("heights", i, "another direction than that of widths");
        lamp.direction = across.normalized();
        const double area = across.length() * (isRound ? kPi / 4 : 1);
        lamp.strength = strengthOf(v[3][i], "radiance", i, area);
        lamp.spread = v[4][i].x * kPi / 180;
        if (!(lamp.spread >= Lamp::kLeastSpread && lamp.spread <= kPi))
            refuse("spread", i, "degrees, 0.573 to 180");
        return lamp;
    });
}

LampsObject together(const LampsObject& a, const LampsObject& b) {
    LampsObject all = a;
    all.lamps.insert(all.lamps.end(), b.lamps.begin(), b.lamps.end());
    return all;
}

std::vector<std::string> namesOf(const LampsObject& lamps) {
    std::vector<std::string> names;
    for (const Lamp& lamp : lamps.lamps) names.push_back(lamp.name);
    return names;
}

/// Calls `visit` for each number that makes a lamp of arrays, which it may change.
template <class Visit>
void forEachNumber(Lamp& lamp, const Visit& visit) {
    const auto visitAll = [&](auto& vector) {
        for (int k = 0; k < 3; ++k) visit(vector[k]);
    };
    bool isSpot = lamp.cone.has_value();
    LampCone cone = lamp.cone.value_or(LampCone());
    visit(lamp.form);
    visitAll(lamp.strength);
    for (Vec3d* vector : {&lamp.position, &lamp.direction, &lamp.halfWidth, &lamp.halfHeight})
        visitAll(*vector);
    for (double* number : {&lamp.radius, &lamp.angle, &lamp.spread}) visit(*number);
    visit(lamp.seenByCamera);
    visit(isSpot);
    visit(cone.cosInner);
    visit(cone.cosOuter);
    if (isSpot) lamp.cone = cone;
}

constexpr py::ssize_t kNumbersOfLamp = 23;

/// A row of numbers for each lamp, and their names.
py::tuple stateOfLamps(const LampsObject& lamps) {
    std::vector<double> numbers;
    for (Lamp lamp : lamps.lamps)
        forEachNumber(lamp,
                      [&](const auto& number) { numbers.push_back(static_cast<double>(number)); });
    return py::make_tuple(
        arrayOf<double>({static_cast<py::ssize_t>(lamps.lamps.size()), kNumbersOfLamp},
                        std::move(numbers)),
        namesOf(lamps));
}

LampsObject lampsOfState(const py::tuple& state) {
    if (py::len(state) != 2)
        throw Error("Lamps: pickled as " + std::to_string(py::len(state)) +
                    " objects, expected an array and names");
    const Doubles numbers = doublesOf(state[0], "Lamps");
    const auto names = state[1].cast<std::vector<std::string>>();
    if (numbers.ndim() != 2 || numbers.shape(1) != kNumbersOfLamp)
        throw Error("Lamps: pickled as an array of shape " + shapeText(numbers) +
                    ", expected (n, " + std::to_string(kNumbersOfLamp) + ")");
    LampsObject lamps;
    lamps.lamps.resize(static_cast<std::size_t>(numbers.shape(0)));
    if (names.size() != lamps.lamps.size())
        throw Error("Lamps: pickled with " + std::to_string(names.size()) + " names, expected " +
                    std::to_string(lamps.lamps.size()));
    const double* next = numbers.data();
    for (std::size_t i = 0; i < names.size(); ++i) {
        Lamp& lamp = lamps.lamps[i];
        lamp.name = names[i];
        forEachNumber(lamp, [&next](auto& number) {
            number = static_cast<std::remove_reference_t<decltype(number)>>(*next++);
        });
    }
    return lamps;
}

SceneObject withLamps(const SceneObject& scene, const LampsObject& lamps,
                      const py::object& progress, int threads) {
    requireNoFrame(*scene.set, "Scene.with_lamps");
    SceneObject lit = scene;
    lit.lamps = together(scene.lamps, lamps);
    lit.set = longCall(
        progress,
        [from = scene.set, more = lamps.lamps] {
            TriangleMesh mesh = from->mesh;
            for (Lamp lamp : more) {
                lamp.position -= mesh.origin;
                mesh.lamps.push_back(std::move(lamp));
            }
            return std::make_shared<const LoadedSet>(std::move(mesh), from->options, from->shots);
        },
        threads);
    return lit;
}

}  // namespace

void defineLamps(py::module_& module) {
    py::class_<LampsObject>(
        module, "Lamps",
        "Lamps of arrays, for Scene.with_lamps(). They have no surface: they stop no ray. One\n"
        "lamp for each row of the arguments, which are broadcast: places and vectors are (..., 3)\n"
        "in world space, light is linear RGB (..., 3) or one number, other numbers are (...).\n"
        "`a + b` has the lamps of both. Pickled as arrays and names.\n\n"
        "camera: whether cameras see them, where they have a radius, an angle or an area: they\n"
        "    add their radiance to what is behind them. All do not, unless it is True.\n"
        "name: of all lamps that the call makes, by which light_groups= of render() has them and\n"
        "    messages call them: 'points', 'spots', 'suns' or 'areas' unless it is given. Those "
        "of\n"
        "    one name are one group; '': none, so that their light is that of the rest.")
        .def_static("points", points, py::arg("positions"), py::arg("intensity"), py::kw_only(),
                    py::arg("radius") = 0.0, py::arg("camera") = false, py::arg("name") = "points",
                    "Lamps that shine to all sides.\n\n"
                    "intensity: [radiance m^2]; 1 makes an irradiance of 1 at a distance of 1 m.\n"
                    "radius: of a disc that faces what it lights [m]; 0: a point.\n"
                    "camera, name: as of Lamps.")
        .def_static("spots", spots, py::arg("positions"), py::arg("directions"),
                    py::arg("intensity"), py::kw_only(), py::arg("inner") = 0.0,
                    py::arg("outer") = 45.0, py::arg("radius") = 0.0, py::arg("camera") = false,
                    py::arg("name") = "spots",
                    "Points that shine into a cone about a direction, of any length.\n\n"
                    "inner, outer: angles to the direction up to which nothing is lost, and from\n"
                    "    which on there is no light [degrees], as KHR_lights_punctual has them.\n"
                    "intensity, radius: as of points(). camera, name: as of Lamps.")
        .def_static("suns", suns, py::arg("directions"), py::arg("irradiance"), py::kw_only(),
                    py::arg("angle") = 0.0, py::arg("camera") = false, py::arg("name") = "suns",
                    "Lamps infinitely far away.\n\n"
                    "directions: to which they shine, of any length.\n"
                    "irradiance: of what they shine on at right angles [radiance sr].\n"
                    "angle: diameter of the disc [degrees]; 0: one direction.\n"
                    "camera, name: as of Lamps.")
        .def_static(
            "areas", areas, py::arg("positions"), py::arg("widths"), py::arg("heights"),
            py::arg("radiance"), py::kw_only(), py::arg("shape") = "rectangle",
            py::arg("spread") = 180.0, py::arg("camera") = false, py::arg("name") = "areas",
            "Areas that shine on one side, that of the cross product of width and height.\n\n"
            "positions: of their middles. widths, heights: vectors along two sides, as long\n"
            "    as these [m]; of an ellipse its diameters.\n"
            "radiance: of the area, along its axis. shape: 'rectangle' or 'ellipse'.\n"
            "spread: slats before it leave the share max(0, 1 - tan(t) / tan(spread / 2)) at an\n"
            "    angle t to its axis [degrees, 0.573 to 180]; 180: none.\n"
            "camera, name: as of Lamps.")
        .def(py::pickle(&stateOfLamps, &lampsOfState))
        .def("__add__", together, py::arg("other"))
        .def_property_readonly("names", namesOf, "The name of each lamp.")
        .def("__len__", [](const LampsObject& l) { return l.lamps.size(); })
        .def("__repr__", [](const LampsObject& l) {
            return "<shadowcache.Lamps: " + std::to_string(l.lamps.size()) + ">";
        });
    py::class_<SceneObject> scene = module.attr("Scene");
    scene
        .def(
            "with_lamps", withLamps, py::arg("lamps"), py::kw_only(),
            py::arg("progress") = py::none(), py::arg("threads") = 0,
            "A Scene of the same set with more Lamps. Its cache is the same one; bake it with the\n"
            "lamps where they are, so that it knows whence they are seen: their strength may\n"
            "change. Raises Error for a Scene that at_frame() made: call it of the one with lamps.")
        .def_property_readonly(
            "lamps", [](const SceneObject& s) { return s.set->mesh.lamps.size(); },
            "Number of lamps, those of files and those of with_lamps(); those that move in a "
            "frame.");
}

}  // namespace shadowcache::python
