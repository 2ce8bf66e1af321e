#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <algorithm>
#include <cstddef>
#include <initializer_list>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/base/interrupt.h"
#include "common/math/vec.h"

namespace shadowcache::python {

using Doubles = pybind11::array_t<double, pybind11::array::c_style>;
using Shape = std::vector<pybind11::ssize_t>;

/// An array of real numbers, as it is.
///
/// @param name  of the argument in messages
/// @throws TypeError if it has other values; ValueError if some are masked
pybind11::array numbersOf(const pybind11::object& value, const char* name);

/// The same as doubles in the order of C.
///
/// @throws MemoryError
Doubles doublesOf(const pybind11::object& value, const char* name);

/// The same with a last axis of three.
///
/// @throws ValueError if it has none
Doubles vectorsOf(const pybind11::object& value, const char* name);

/// "(4, 3)"
std::string shapeText(const pybind11::array& array);

/// An argument and its name in messages.
struct Argument {
    const char* name;
    const pybind11::object& value;
};

/// Arguments with a last axis of three, in one common shape by NumPy's rules of broadcasting. What
/// they repeat is not copied: vectors are read in parts, without the interpreter's lock.
class Broadcast {
public:
    /// @throws TypeError, ValueError and MemoryError as vectorsOf(); ValueError if they do not fit
    Broadcast(std::initializer_list<Argument> arguments);

    /// Without the last axis, and with others behind.
    Shape shape(std::initializer_list<pybind11::ssize_t> more = {}) const;
    /// Vectors of each argument.
    std::size_t size() const { return size_; }
    std::size_t arguments() const { return arrays_.size(); }

    /// The vectors of an argument from number `first` on, in the order of C.
    void read(std::size_t argument, std::size_t first, std::span<Vec3d> out) const;

private:
    Shape shape_;
    std::size_t size_ = 1;
    std::vector<pybind11::array> arrays_;  ///< of that shape; repeated by strides of 0
    struct View {
        const std::byte* data;
        Shape strides;  ///< of all axes [bytes]
    };
    std::vector<View> views_;
};

/// Vectors of a call's part, at most: some 20 MB for each argument.
inline constexpr std::size_t kMostOfPart = std::size_t{1} << 20;

/// Calls `work(first, vectors)` for one part of the vectors after the other; vectors[k] are those
/// of argument k. Needs no lock.
///
/// @throws Interrupted
template <class Work>
void forEachPart(const Broadcast& all, std::size_t mostOfPart, const Work& work) {
    std::vector<std::vector<Vec3d>> vectors(all.arguments());
    for (std::size_t first = 0; first < all.size(); first += mostOfPart) {
        throwIfInterrupted();
        const std::size_t count = std::min(mostOfPart, all.size() - first);
        for (std::size_t k = 0; k < vectors.size(); ++k) {
            vectors[k].resize(count);
            all.read(k, first, vectors[k]);
        }
        work(first, vectors);
    }
}

/// The vectors of an array with a last axis of three.
inline std::span<const Vec3d> vectorsIn(const Doubles& array) {
    static_assert(sizeof(Vec3d) == 3 * sizeof(double));
    return {reinterpret_cast<const Vec3d*>(array.data()),
            static_cast<std::size_t>(array.size()) / 3};
}

/// One vector. @throws ValueError unless it is one, of finite numbers
Vec3d vectorOf(const pybind11::object& value, const char* name);

/// One colour, or a number that is all three. @throws ValueError unless it is one, of finite
/// numbers
Vec3d colorOf(const pybind11::object& value, const char* name);

/// A new array, for a call to fill. @throws MemoryError
template <class Number>
pybind11::array_t<Number> newArray(const Shape& shape) {
    return pybind11::array_t<Number>(shape);
}

/// What a new array holds, as values of several numbers each.
template <class Value, class Number>
std::span<Value> valuesOf(pybind11::array_t<Number>& array) {
    static_assert(sizeof(Value) % sizeof(Number) == 0);
    return {reinterpret_cast<Value*>(array.mutable_data()),
            static_cast<std::size_t>(array.size()) * sizeof(Number) / sizeof(Value)};
}

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
