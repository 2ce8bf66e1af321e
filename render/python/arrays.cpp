#include "render/python/arrays.h"

#include <cmath>

namespace shadowcache::python {

namespace py = pybind11;

std::string shapeText(const py::array& array) {
    return py::str(array.attr("shape"));
}

Doubles doublesOf(const py::object& value, const char* name) {
    const py::array array = py::module_::import("numpy").attr("asarray")(value);
    const char kind = array.dtype().kind();
    if (kind != 'f' && kind != 'i' && kind != 'u')
        throw py::type_error(std::string(name) + ": dtype " +
                             std::string(py::str(py::object(array.dtype()))) +
                             ", expected real numbers, as of float32 or float64");
    return Doubles::ensure(array);
}

Doubles vectorsOf(const py::object& value, const char* name) {
    Doubles array = doublesOf(value, name);
    if (array.ndim() < 1 || array.shape(array.ndim() - 1) != 3)
        throw py::value_error(std::string(name) + ": shape " + shapeText(array) +
                              ", expected (..., 3)");
    return array;
}

Broadcast broadcast(const std::vector<Doubles>& arrays) {
    const py::module_ numpy = py::module_::import("numpy");
    py::list all;
    for (const Doubles& array : arrays) all.append(array);
    Broadcast result;
    for (const py::handle each : numpy.attr("broadcast_arrays")(*all))
        result.arrays.push_back(Doubles::ensure(each));
    const Doubles& first = result.arrays.front();
    result.shape.assign(first.shape(), first.shape() + first.ndim() - 1);
    return result;
}

Vec3d vectorOf(const py::object& value, const char* name) {
    const Doubles array = vectorsOf(value, name);
    if (array.size() != 3)
        throw py::value_error(std::string(name) + ": shape " + shapeText(array) +
                              ", expected (3,)");
    const Vec3d v = vectorsIn(array).front();
    if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z))
        throw py::value_error(std::string(name) + ": expected finite numbers");
    return v;
}

}  // namespace shadowcache::python
