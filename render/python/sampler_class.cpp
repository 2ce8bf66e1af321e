#include <algorithm>
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

/// What is known of samples, as arrays.
class Columns {
public:
    explicit Columns(const Shape& shape) : pdf_(newArray<double>(shape)) {
        Shape vectors = shape;
        vectors.push_back(3);
        for (auto* each : {&direction_, &radiance_, &control_}) *each = newArray<float>(vectors);
        directions_ = valuesOf<Vec3f>(direction_);
        radiances_ = valuesOf<Rgb>(radiance_);
        controls_ = valuesOf<Rgb>(control_);
        densities_ = valuesOf<double>(pdf_);
    }

    /// Samples from number `first` on. Needs no lock.
    void write(std::size_t first, std::span<const LightSample> samples) {
        for (const LightSample& sample : samples) {
            directions_[first] = sample.direction;
            radiances_[first] = sample.radiance;
            controls_[first] = sample.control;
            densities_[first++] = sample.pdf;
        }
    }

    py::dict dict() const {
        using namespace py::literals;
        return py::dict("direction"_a = direction_, "radiance"_a = radiance_,
                        "control"_a = control_, "pdf"_a = pdf_);
    }

private:
    py::array_t<float> direction_, radiance_, control_;
    py::array_t<double> pdf_;
    std::span<Vec3f> directions_;
    std::span<Rgb> radiances_, controls_;
    std::span<double> densities_;
};

py::dict sampleAt(const SamplerObject& sampler, const py::object& points, const py::object& normals,
                  std::uint32_t count, std::uint64_t seed, bool control, const py::object& progress,
                  int threads) {
    const Broadcast all({{"points", points}, {"normals", normals}});
    const SamplerObject kept = sampler;
    Columns columns(all.shape({count}));
    py::array_t<float> integral = newArray<float>(all.shape({3}));
    const std::span<Rgb> integrals = valuesOf<Rgb>(integral);
    runLong(
        progress,
        [&] {
            const std::size_t most = std::max<std::size_t>(1, kMostOfPart / std::max(1u, count));
            std::vector<LightSample> samples;
            forEachPart(all, most, [&](std::size_t first, const auto& vectors) {
                samples.resize(vectors[0].size() * count);
                samplePlaces(*kept.sampler, {vectors[0], vectors[1]}, aimOf(control), {seed, first},
                             samples, integrals.subspan(first, vectors[0].size()));
                columns.write(first * count, samples);
            });
        },
        threads);
    py::dict dict = columns.dict();
    dict["integral"] = integral;
    return dict;
}

py::dict lookUpAt(const SamplerObject& sampler, const py::object& points, const py::object& normals,
                  const py::object& directions, bool control, const py::object& progress,
                  int threads) {
    const Broadcast all({{"points", points}, {"normals", normals}, {"directions", directions}});
    const SamplerObject kept = sampler;
    Columns columns(all.shape());
    runLong(
        progress,
        [&] {
            std::vector<LightSample> along;
            forEachPart(all, kMostOfPart, [&](std::size_t first, const auto& vectors) {
                along.resize(vectors[0].size());
                readAlong(*kept.sampler, {vectors[0], vectors[1]}, aimOf(control), vectors[2],
                          along);
                columns.write(first, along);
            });
        },
        threads);
    return columns.dict();
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
