#include "render/python/arrays.h"

#include <cmath>

namespace shadowcache::python {

namespace py = pybind11;

namespace {

/// Native, aligned doubles in the order of C, as NumPy converts them.
py::array toDoubles(const py::array& array) {
    return py::module_::import("numpy").attr("require")(array, "f8", "CAE");
}

void requireVectors(const py::array& array, const char* name) {
    if (array.ndim() < 1 || array.shape(array.ndim() - 1) != 3)
        throw py::value_error(std::string(name) + ": shape " + shapeText(array) +
                              ", expected (..., 3)");
}

/// One of what an array repeats along its axes but the last.
py::array withoutRepeats(const py::array& array) {
    py::tuple places(static_cast<std::size_t>(array.ndim()));
    for (py::ssize_t axis = 0; axis < array.ndim(); ++axis) {
        const bool repeats =
            axis + 1 < array.ndim() && array.strides(axis) == 0 && array.shape(axis) > 1;
        places[static_cast<std::size_t>(axis)] =
            repeats ? py::slice(0, 1, 1) : py::slice(py::none(), py::none(), py::none());
    }
    return array[places];
}

}  // namespace

std::string shapeText(const py::array& array) {
    return py::str(array.attr("shape"));
}

py::array numbersOf(const py::object& value, const char* name) {
    const py::module_ numpy = py::module_::import("numpy");
    if (numpy.attr("ma").attr("is_masked")(value).cast<bool>())
        throw py::value_error(std::string(name) +
                              ": some values are masked; fill them first, as by .filled(nan)");
    py::array array = numpy.attr("asarray")(value);
    const char kind = array.dtype().kind();
    if (kind != 'f' && kind != 'i' && kind != 'u')
        throw py::type_error(std::string(name) + ": dtype " +
                             std::string(py::str(py::object(array.dtype()))) +
                             ", expected real numbers, as of float32 or float64");
    return array;
}

Doubles doublesOf(const py::object& value, const char* name) {
    return Doubles(toDoubles(numbersOf(value, name)));
}

Doubles vectorsOf(const py::object& value, const char* name) {
    const py::array array = numbersOf(value, name);
    requireVectors(array, name);
    return Doubles(toDoubles(array));
}

Broadcast::Broadcast(std::initializer_list<Argument> arguments) {
    const py::module_ numpy = py::module_::import("numpy");
    py::list all;
    for (const Argument& argument : arguments) {
        const py::array array = numbersOf(argument.value, argument.name);
        requireVectors(array, argument.name);
        all.append(
            numpy.attr("broadcast_to")(toDoubles(withoutRepeats(array)), array.attr("shape")));
    }
    for (const py::handle each : numpy.attr("broadcast_arrays")(*all)) {
        arrays_.push_back(py::reinterpret_borrow<py::array>(each));
        const py::array& array = arrays_.back();
        views_.push_back({static_cast<const std::byte*>(array.data()),
                          {array.strides(), array.strides() + array.ndim()}});
    }
    const py::array& first = arrays_.front();
    shape_.assign(first.shape(), first.shape() + first.ndim() - 1);
    for (const py::ssize_t extent : shape_) size_ *= static_cast<std::size_t>(extent);
}

Shape Broadcast::shape(std::initializer_list<py::ssize_t> more) const {
    Shape shape = shape_;
    shape.insert(shape.end(), more);
    return shape;
}

void Broadcast::read(std::size_t argument, std::size_t first, std::span<Vec3d> out) const {
    if (out.empty()) return;
    const View& view = views_[argument];
    const std::size_t axes = shape_.size();
    Shape at(axes);
    const std::byte* place = view.data;
    for (std::size_t axis = axes; axis-- > 0;) {
        const auto extent = static_cast<std::size_t>(shape_[axis]);
        at[axis] = static_cast<py::ssize_t>(first % extent);
        place += at[axis] * view.strides[axis];
        first /= extent;
    }
    const py::ssize_t step = view.strides[axes];
    for (Vec3d& vector : out) {
        for (int k = 0; k < 3; ++k) vector[k] = *reinterpret_cast<const double*>(place + k * step);
        for (std::size_t axis = axes; axis-- > 0;) {
            place += view.strides[axis];
            if (++at[axis] < shape_[axis]) break;
            place -= at[axis] * view.strides[axis];
            at[axis] = 0;
        }
    }
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

Vec3d colorOf(const py::object& value, const char* name) {
    const py::array array = numbersOf(value, name);
    if (array.size() != 1) return vectorOf(array, name);
    const double number = doublesOf(array, name).data()[0];
    if (!std::isfinite(number))
        throw py::value_error(std::string(name) + ": expected finite numbers");
    return Vec3d(number);
}

}  // namespace shadowcache::python
