#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/math/vec.h"

namespace shadowcache::python {

using Doubles = pybind11::array_t<double, pybind11::array::c_style>;
using Shape = std::vector<pybind11::ssize_t>;

/// An array of real numbers, as doubles in the order of C.
///
/// @param name  of the argument in messages
/// @throws TypeError if it has other values
Doubles doublesOf(const pybind11::object& value, const char* name);

/// The same with a last axis of three.
///
/// @throws ValueError if it has none
Doubles vectorsOf(const pybind11::object& value, const char* name);

/// "(4, 3)"
std::string shapeText(const pybind11::array& array);

/// Arrays with a last axis of three, in one common shape by NumPy's rules of broadcasting.
struct Broadcast {
    Shape shape;                  ///< without the last axis
    std::vector<Doubles> arrays;  ///< of that shape
};
Broadcast broadcast(const std::vector<Doubles>& arrays);

/// The vectors of an array with a last axis of three.
inline std::span<const Vec3d> vectorsIn(const Doubles& array) {
    static_assert(sizeof(Vec3d) == 3 * sizeof(double));
    return {reinterpret_cast<const Vec3d*>(array.data()),
            static_cast<std::size_t>(array.size()) / 3};
}

/// One vector. @throws ValueError unless it is one, of finite numbers
Vec3d vectorOf(const pybind11::object& value, const char* name);

/// An array that takes over what `values` holds, without a copy.
template <class Number, class Values>
pybind11::array_t<Number> arrayOf(const Shape& shape, Values values) {
    auto owned = std::make_unique<Values>(std::move(values));
    const auto* data = reinterpret_cast<const Number*>(owned->data());
    const pybind11::capsule owner(owned.release(),
                                  [](void* all) { delete static_cast<Values*>(all); });
    return pybind11::array_t<Number>(shape, data, owner);
}

}  // namespace shadowcache::python
