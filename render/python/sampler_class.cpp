#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "render/python/arrays.h"
#include "render/python/classes.h"
#include "render/python/long_call.h"
#include "render/samples/sample_places.h"

namespace shadowcache::python {

namespace py = pybind11;

namespace {

/// LightSampler, with what it refers to.
struct SamplerObject {
    std::shared_ptr<const ShadowCache> cache;
    std::shared_ptr<const Environment> light;
    std::shared_ptr<const LightSampler> sampler;
};

std::shared_ptr<SamplerObject> samplerOf(const CacheObject& cache,
                                         const EnvironmentObject& environment) {
    return std::make_shared<SamplerObject>(
        SamplerObject{cache.cache, environment.light,
                      std::make_shared<const LightSampler>(*cache.cache, *environment.light)});
}

SampleAim aimOf(bool control) {
    return control ? SampleAim::difference : SampleAim::light;
}

/// What is known of samples, as arrays; `shape` is theirs.
py::dict columnsOf(const std::vector<LightSample>& samples, const Shape& shape) {
    std::vector<Vec3f> directions;
    std::vector<Rgb> radiances, controls;
    std::vector<double> densities;
    for (const LightSample& sample : samples) {
        directions.push_back(sample.direction);
        radiances.push_back(sample.radiance);
        controls.push_back(sample.control);
        densities.push_back(sample.pdf);
    }
    Shape vectors = shape;
    vectors.push_back(3);
    using namespace py::literals;
    return py::dict("direction"_a = arrayOf<float>(vectors, std::move(directions)),
                    "radiance"_a = arrayOf<float>(vectors, std::move(radiances)),
                    "control"_a = arrayOf<float>(vectors, std::move(controls)),
                    "pdf"_a = arrayOf<double>(shape, std::move(densities)));
}

py::dict sampleAt(const SamplerObject& sampler, const py::object& points, const py::object& normals,
                  std::uint32_t count, std::uint64_t seed, bool control, const py::object& progress,
                  int threads) {
    Broadcast all = broadcast({vectorsOf(points, "points"), vectorsOf(normals, "normals")});
    const SamplerObject kept = sampler;
    const SampleAim aim = aimOf(control);
    std::vector<LightSample> samples;
    std::vector<Rgb> integrals = longCall(
        progress,
        [&] {
            const Places places{vectorsIn(all.arrays[0]), vectorsIn(all.arrays[1])};
            samples.resize(places.size() * count);
            std::vector<Rgb> values(places.size());
            samplePlaces(*kept.sampler, places, aim, seed, samples, values);
            return values;
        },
        threads);
    Shape shape = all.shape;
    shape.push_back(count);
    py::dict columns = columnsOf(samples, shape);
    all.shape.push_back(3);
    columns["integral"] = arrayOf<float>(all.shape, std::move(integrals));
    return columns;
}

py::dict lookUpAt(const SamplerObject& sampler, const py::object& points, const py::object& normals,
                  const py::object& directions, bool control, const py::object& progress,
                  int threads) {
    const Broadcast all = broadcast({vectorsOf(points, "points"), vectorsOf(normals, "normals"),
                                     vectorsOf(directions, "directions")});
    const SamplerObject kept = sampler;
    const SampleAim aim = aimOf(control);
    const std::vector<LightSample> found = longCall(
        progress,
        [&] {
            const Places places{vectorsIn(all.arrays[0]), vectorsIn(all.arrays[1])};
            std::vector<LightSample> along(places.size());
            readAlong(*kept.sampler, places, aim, vectorsIn(all.arrays[2]), along);
            return along;
        },
        threads);
    return columnsOf(found, all.shape);
}

}  // namespace

void defineSampler(py::module_& module) {
    py::class_<SamplerObject, std::shared_ptr<SamplerObject>>(
        module, "LightSampler",
        "Directions to the light at places of a cached set, for a renderer that traces the rays\n"
        "itself. With V the visibility that rays find, both\n\n"
        "    integral + mean((V * max(0, cosine) * radiance - control) / pdf)\n"
        "    mean(V * max(0, cosine) * radiance / pdf)\n\n"
        "are the irradiance, free of bias whatever the cache holds. `control` says which of them\n"
        "the directions are for: they follow what the control variate is predicted to leave, or\n"
        "light times cosine times cached visibility.")
        .def("sample", sampleAt, py::arg("points"), py::arg("normals"), py::kw_only(),
             py::arg("count") = 1, py::arg("seed") = 1, py::arg("control") = true,
             py::arg("progress") = py::none(), py::arg("threads") = 0,
             "Draws `count` directions at each place.\n\n"
             "points: places on the set [m], normals: towards the side that is lit; (..., 3)\n"
             "    each, broadcast; normals of any length.\n"
             "Returns a dict: 'direction' (..., count, 3), unit, perhaps below the horizon;\n"
             "'radiance' along it and 'control', the control variate's (..., count, 3); 'pdf'\n"
             "(..., count) float64 [1/sr], 0 where no light reaches the place: such samples count\n"
             "as 0; 'integral' (..., 3), the control variate's over all directions [radiance sr],\n"
             "NaN where an input is not finite or a zero vector.")
        .def(
            "look_up", lookUpAt, py::arg("points"), py::arg("normals"), py::arg("directions"),
            py::kw_only(), py::arg("control") = true, py::arg("progress") = py::none(),
            py::arg("threads") = 0,
            "What sample() returns where it draws these directions, (..., 3), broadcast with the\n"
            "places: a dict of 'direction', unit, 'radiance', 'control' (..., 3) and 'pdf' (...),\n"
            "0 where it draws none, NaN where an input is not finite or a zero vector.")
        .def("__repr__", [](const SamplerObject& s) {
            return "<shadowcache.LightSampler: " + std::to_string(s.cache->itemCount()) + " items>";
        });
    py::class_<CacheObject, std::shared_ptr<CacheObject>> cache = module.attr("Cache");
    cache.def("sampler", samplerOf, py::arg("environment"),
              "A LightSampler of the light of an Environment.");
}

}  // namespace shadowcache::python
