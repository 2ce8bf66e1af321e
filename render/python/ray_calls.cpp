#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "common/base/parallel.h"
#include "common/predict/places.h"
#include "common/shot/view.h"
#include "render/bounces/item_looks.h"
#include "render/python/arrays.h"
#include "render/python/classes.h"
#include "render/python/long_call.h"

namespace shadowcache::python {

namespace py = pybind11;

namespace {

/// Rays that a thread takes at a time.
constexpr std::size_t kRaysAtOnce = 4096;

/// Calls `begin(first, count)` for rays that are next, and then `trace(first, rays, numbers)` for
/// those that are some, a few near ones at a time.
///
/// @tparam kSize  rays at a time, at most
template <std::size_t kSize, class Begin, class Trace>
void forEachBundle(const Broadcast& all, const Begin& begin, const Trace& trace) {
    forEachPart(all, kMostOfPart, [&](std::size_t first, const auto& vectors) {
        const Places rays{vectors[0], vectors[1]};
        parallelFor(rays.size(), kRaysAtOnce, [&](const Chunk& chunk) {
            begin(first + chunk.begin, chunk.end - chunk.begin);
            std::array<std::size_t, kSize> numbers;
            std::size_t count = 0;
            const auto flush = [&] {
                if (count > 0) trace(first, rays, std::span(numbers).first(count));
                count = 0;
            };
            for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
                if (!isPlace(rays, i)) continue;
                numbers[count++] = i;
                if (count == kSize) flush();
            }
            flush();
        });
    });
}

/// What rays meet, as arrays.
struct MetArrays {
    py::array_t<float> distance, normal, albedo;
    py::array_t<double> position, start;
    py::array_t<std::int64_t> triangle;

    explicit MetArrays(const Broadcast& all)
        : distance(newArray<float>(all.shape())),
          normal(newArray<float>(all.shape({3}))),
          albedo(newArray<float>(all.shape({3}))),
          position(newArray<double>(all.shape({3}))),
          start(newArray<double>(all.shape({3}))),
          triangle(newArray<std::int64_t>(all.shape())) {}
};

py::dict intersect(const SceneObject& scene, const py::object& origins,
                   const py::object& directions, const py::object& progress, int threads) {
    const Broadcast all({{"origins", origins}, {"directions", directions}});
    MetArrays arrays(all);
    const auto distances = valuesOf<float>(arrays.distance);
    const auto normals = valuesOf<Vec3f>(arrays.normal);
    const auto albedos = valuesOf<Rgb>(arrays.albedo);
    const auto positions = valuesOf<Vec3d>(arrays.position);
    const auto starts = valuesOf<Vec3d>(arrays.start);
    const auto triangles = valuesOf<std::int64_t>(arrays.triangle);
    const auto set = scene.set;
    runLong(
        progress,
        [&] {
            constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
            constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
            const auto begin = [&](std::size_t first, std::size_t count) {
                std::ranges::fill(distances.subspan(first, count), kNone);
                std::ranges::fill(normals.subspan(first, count), Vec3f(kNone));
                std::ranges::fill(albedos.subspan(first, count), Rgb(kNone));
                std::ranges::fill(positions.subspan(first, count), Vec3d(kNaN));
                std::ranges::fill(starts.subspan(first, count), Vec3d(kNaN));
                std::ranges::fill(triangles.subspan(first, count), -1);
            };
            const Vec3d& origin = set->mesh.origin;
            constexpr auto kSize = static_cast<std::size_t>(RayPacket::kSize);
            forEachBundle<kSize>(
                all, begin,
                [&](std::size_t first, const Places& rays, std::span<const std::size_t> numbers) {
                    RayPacket packet{};
                    std::array<Hit, kSize> hits;
                    std::array<Vec3f, kSize> along;
                    for (std::size_t k = 0; k < numbers.size(); ++k) {
                        along[k] = Vec3f(unitAlong(rays.normals[numbers[k]]));
                        packet.set(static_cast<int>(k), Vec3f(rays.positions[numbers[k]] - origin),
                                   along[k]);
                    }
                    set->scene.intersect(packet, static_cast<int>(numbers.size()), hits.data());
                    for (std::size_t k = 0; k < numbers.size(); ++k) {
                        const std::size_t at = first + numbers[k];
                        const Hit& hit = hits[k];
                        distances[at] =
                            hit.found ? hit.distance : std::numeric_limits<float>::infinity();
                        if (!hit.found) continue;
                        const Vec3f normal = View{along[k], hit}.geometricNormal();
                        normals[at] = normal;
                        albedos[at] = lookOf(hit, {}).albedo;
                        positions[at] = worldPosition(set->scene, hit);
                        starts[at] = origin + Vec3d(hit.scene->rayOrigin(hit.position, hit.triangle,
                                                                         normal));
                        if (hit.scene == &set->scene) triangles[at] = hit.triangle;
                    }
                });
        },
        threads);
    using namespace py::literals;
    return py::dict("distance"_a = arrays.distance, "position"_a = arrays.position,
                    "normal"_a = arrays.normal, "albedo"_a = arrays.albedo,
                    "start"_a = arrays.start, "triangle"_a = arrays.triangle);
}

py::object occluded(const SceneObject& scene, const py::object& origins,
                    const py::object& directions, double reach, const py::object& progress,
                    int threads) {
    if (!(reach > 0)) throw py::value_error("reach: expected a length above 0");
    const Broadcast all({{"origins", origins}, {"directions", directions}});
    py::array_t<bool> out = newArray<bool>(all.shape());
    const std::span<bool> stopped = valuesOf<bool>(out);
    const auto set = scene.set;
    runLong(
        progress,
        [&] {
            const auto begin = [&](std::size_t first, std::size_t count) {
                std::ranges::fill(stopped.subspan(first, count), false);
            };
            constexpr auto kMost = static_cast<double>(std::numeric_limits<float>::max());
            const auto most = static_cast<float>(std::min(reach, kMost));
            forEachBundle<RayStream::kSize>(
                all, begin,
                [&](std::size_t first, const Places& rays, std::span<const std::size_t> numbers) {
                    RayStream stream{};
                    for (std::size_t k = 0; k < numbers.size(); ++k) {
                        const Vec3f origin(rays.positions[numbers[k]] - set->mesh.origin);
                        const Vec3f along(unitAlong(rays.normals[numbers[k]]));
                        for (int axis = 0; axis < 3; ++axis) {
                            stream.origin[axis][k] = origin[axis];
                            stream.direction[axis][k] = along[axis];
                        }
                        stream.reach[k] = most;
                    }
                    set->scene.trace(stream, numbers.size());
                    for (std::size_t k = 0; k < numbers.size(); ++k)
                        stopped[first + numbers[k]] = stream.reach[k] < 0;
                });
        },
        threads);
    return out.ndim() == 0 ? py::object(out.attr("item")()) : py::object(out);
}

}  // namespace

void defineRays(py::module_& module) {
    py::class_<SceneObject> scene = module.attr("Scene");
    scene
        .def(
            "intersect", intersect, py::arg("origins"), py::arg("directions"), py::kw_only(),
            py::arg("progress") = py::none(), py::arg("threads") = 0,
            "What rays meet first, as camera rays do: through holes of textures, and through the\n"
            "backs of surfaces that are not double-sided.\n\n"
            "origins: places [m], directions: of any length; (..., 3) each, broadcast.\n"
            "Returns a dict: 'distance' (...) float32 [m], infinite where nothing is met;\n"
            "'position' (..., 3) float64; 'normal' (..., 3) float32, unit, of the triangle on the\n"
            "ray's side; 'albedo' (..., 3) float32, linear, gloss included, .5 without a "
            "material;\n"
            "'start' (..., 3) float64, where rays that leave the place start: off the surface by\n"
            "its rounding; 'triangle' (...) int64, its number, -1 for none and on what moves. NaN\n"
            "where there is no such thing, or an input is not finite or a zero vector.")
        .def(
            "occluded", occluded, py::arg("origins"), py::arg("directions"), py::kw_only(),
            py::arg("reach") = std::numeric_limits<double>::infinity(),
            py::arg("progress") = py::none(), py::arg("threads") = 0,
            "Whether rays of light are stopped within `reach` metres: shadow rays, which pass\n"
            "holes of textures, and surfaces that blend by the chance of their transparency.\n\n"
            "origins: places off the surfaces, as intersect()['start'] has them, directions: of\n"
            "    any length; (..., 3) each, broadcast.\n"
            "Returns bool of the common shape (...); False where an input is not finite or a zero\n"
            "vector.");
}

}  // namespace shadowcache::python
