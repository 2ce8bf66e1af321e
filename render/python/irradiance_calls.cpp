#include <pybind11/stl.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "common/base/error.h"
#include "common/cache/transport.h"
#include "common/predict/many_places.h"
#include "render/bounces/bounce_task.h"
#include "render/bounces/item_looks.h"
#include "render/library/set_light.h"
#include "render/python/arrays.h"
#include "render/python/classes.h"
#include "render/python/long_call.h"
#include "render/sensors/air_irradiance.h"
#include "render/sensors/own_light.h"
#include "render/sensors/sky_operator.h"
#include "render/sensors/sky_patches.h"

namespace shadowcache::python {

namespace py = pybind11;

namespace {

/// A number of bounces, or "unlimited".
using Bounces = std::variant<int, std::string>;

int bouncesOf(const Bounces& bounces) {
    const auto* number = std::get_if<int>(&bounces);
    if (number && *number >= 0 && *number <= kMostBounces) return *number;
    if (!number && std::get<std::string>(bounces) == "unlimited") return kUnlimitedBounces;
    throw py::value_error("bounces: expected 0 to " + std::to_string(kMostBounces) +
                          ", or 'unlimited'");
}

/// How the light of a call bounces, without what that takes.
SolvedLight bouncing(const CacheObject& cache, const SceneObject* scene, const Bounces& bounces,
                     const py::object& albedo) {
    SolvedLight wanted{};
    wanted.set = scene ? scene->set : nullptr;
    wanted.albedo = Rgb(colorOf(albedo, "albedo"));
    wanted.bounces = bouncesOf(bounces);
    wanted.items = cache.items;
    for (int k = 0; k < 3; ++k)
        if (!(wanted.albedo[k] >= 0 && wanted.albedo[k] <= 1))
            throw py::value_error("albedo: expected 0 to 1");
    requireSetOf(*cache.cache, wanted.set.get());
    return wanted;
}

/// Fills in the items and their looks. Needs no lock.
Transport readPaths(const ShadowCache& cache, SolvedLight& wanted) {
    if (!wanted.items) wanted.items = std::make_shared<const ItemTable>(cache);
    std::optional<Transport> transport = readTransport(cache, *wanted.items);
    if (!transport)
        throw Error(
            "cache: holds no transport, by which bounces are predicted: bake with "
            "transport=True");
    const PlainLook plain{wanted.albedo};
    wanted.looks = std::make_shared<const std::vector<ItemLook>>(
        wanted.set ? looksOf(wanted.set->scene, *wanted.items, plain)
                   : std::vector<ItemLook>(wanted.items->size(), ItemLook{.albedo = plain.albedo}));
    return *std::move(transport);
}

/// Finds what shines in a set, unless that is known. Needs no lock.
/// @throws Error if the cache does not count it as it stands
void findOwnLight(const ShadowCache& cache, const std::shared_ptr<const LoadedSet>& set,
                  OwnLight& own) {
    if (!set || own.set == set) return;
    own = {set, SetLight::of(set->scene, &cache)};
    if (own.light && !own.light->knowsAll())
        throw Error("cache: " + own.light->unknownText() +
                    ": bake the scene as it is, or load it with lamps='off'");
}

/// Solves the light that bounces, unless that is `wanted` already. Needs no lock.
void solveLight(const ShadowCache& cache, const SetLight* own, SolvedLight& wanted) {
    if (wanted.solve) return;
    const Transport transport = readPaths(cache, wanted);
    std::vector<Rgb> ofEmitters;
    if (own) ofEmitters = own->predictItems(*wanted.items);
    wanted.solve = std::make_shared<const BounceSolve>(
        cache, *wanted.items, transport, *wanted.light, *wanted.looks, wanted.bounces, ofEmitters);
}

/// Takes over what the cache's last call has of it.
void takeLast(const CacheObject& cache, SolvedLight& wanted) {
    const SolvedLight& last = cache.solved;
    if (last.light == wanted.light && last.set == wanted.set && last.albedo == wanted.albedo &&
        last.bounces == wanted.bounces)
        wanted = last;
}

/// What a call predicts of places on surfaces, and by rays of those in the air.
void predict(const ShadowCache& cache, const CachePreview& preview, const SolvedLight& wanted,
             const SetLight* own, const Places& places, std::span<Rgb> out) {
    std::vector<Rgb> direct(own ? places.size() : 0);
    if (own) predictOwnLight(wanted.set->scene, own->light(), places, direct);
    if (wanted.bounces == 0) {
        irradianceAt(cache, preview, places, out);
        for (std::size_t i = 0; i < direct.size(); ++i) out[i] += direct[i];
    } else {
        irradianceAt(cache, preview, *wanted.solve, wanted.bounces, places, out, direct);
    }
    const std::vector<std::size_t> inAir =
        placesInAir(wanted.set ? &wanted.set->scene : nullptr, cache.header().spacing, places, out);
    if (inAir.empty()) return;
    if (!wanted.set) refuseInAir(places.positions[inAir.front()]);
    std::optional<BouncingLight> bounced;
    if (wanted.bounces != 0)
        bounced.emplace(BouncingLight{*wanted.solve, *wanted.looks, wanted.bounces});
    irradianceInAir(wanted.set->scene, *wanted.light, bounced ? &*bounced : nullptr, places, inAir,
                    out);
    if (own) addOwnLightByRays(wanted.set->scene, own->light(), places, inAir, out);
}

py::array irradiance(CacheObject& cache, const py::object& points, const py::object& normals,
                     const EnvironmentObject& environment, const Bounces& bounces,
                     const SceneObject* scene, const py::object& albedo, const py::object& progress,
                     int threads) {
    const Broadcast all({{"points", points}, {"normals", normals}});
    const auto kept = cache.cache;
    SolvedLight wanted = bouncing(cache, scene, bounces, albedo);
    wanted.light = environment.light;
    takeLast(cache, wanted);
    OwnLight own = wanted.set && cache.own.set == wanted.set ? cache.own : OwnLight{};
    py::array_t<float> out = newArray<float>(all.shape({3}));
    const std::span<Rgb> values = valuesOf<Rgb>(out);
    runLong(
        progress,
        [&] {
            findOwnLight(*kept, wanted.set, own);
            if (wanted.bounces != 0) solveLight(*kept, own.light.get(), wanted);
            const CachePreview preview(*wanted.light, kept->header().tiers());
            forEachPart(all, kMostOfPart, [&](std::size_t first, const auto& vectors) {
                const Places places{vectors[0], vectors[1]};
                predict(*kept, preview, wanted, own.light.get(), places,
                        values.subspan(first, places.size()));
            });
        },
        threads);
    if (own.set) cache.own = std::move(own);
    if (wanted.bounces != 0) {
        cache.items = wanted.items;
        cache.solved = std::move(wanted);
    }
    return out;
}

void requireLevel(int level) {
    if (level < kCoarsestPatches || level > kFinestPatches)
        throw py::value_error("level: expected " + std::to_string(kCoarsestPatches) + " to " +
                              std::to_string(kFinestPatches));
}

py::array skyOperator(const CacheObject& cache, const py::object& points, const py::object& normals,
                      int level, const Bounces& bounces, const SceneObject* scene,
                      const py::object& albedo, const py::object& progress, int threads) {
    requireLevel(level);
    const Broadcast all({{"points", points}, {"normals", normals}});
    const auto kept = cache.cache;
    SolvedLight wanted = bouncing(cache, scene, bounces, albedo);
    const std::size_t patches = cellCount(level);
    py::array_t<float> out = newArray<float>(all.shape({static_cast<py::ssize_t>(patches), 3}));
    const std::span<Rgb> values = valuesOf<Rgb>(out);
    runLong(
        progress,
        [&] {
            std::optional<Transport> transport;
            std::optional<BouncePaths> paths;
            if (wanted.bounces != 0) {
                transport = readPaths(*kept, wanted);
                paths.emplace(
                    BouncePaths{*wanted.items, *transport, *wanted.looks, wanted.bounces});
            }
            const SkyOperator rows{*kept, wanted.set ? &wanted.set->scene : nullptr,
                                   paths ? &*paths : nullptr, level};
            forEachPart(all, kMostOfPart, [&](std::size_t first, const auto& vectors) {
                const Places places{vectors[0], vectors[1]};
                rows.rows(places, values.subspan(first * patches, places.size() * patches));
            });
        },
        threads);
    return out;
}

py::array patches(const EnvironmentObject& environment, int level, const py::object& progress,
                  int threads) {
    requireLevel(level);
    const auto light = environment.light;
    const Shape shape{static_cast<py::ssize_t>(cellCount(level)), 3};
    std::vector<Vec3d> sums;
    runLong(
        progress, [&] { sums = lightOfPatches(*light, level); }, threads);
    return arrayOf<double>(shape, std::move(sums));
}

py::array patchDirections(int level) {
    requireLevel(level);
    std::vector<Vec3d> all;
    for (std::uint32_t patch = 0; patch < cellCount(level); ++patch)
        all.push_back(cellCenter(level, patch));
    const Shape shape{static_cast<py::ssize_t>(all.size()), 3};
    return arrayOf<double>(shape, std::move(all));
}

}  // namespace

void defineIrradiance(py::module_& module) {
    py::class_<CacheObject, std::shared_ptr<CacheObject>> cache = module.attr("Cache");
    cache
        .def(
            "irradiance", irradiance, py::arg("points"), py::arg("normals"), py::arg("environment"),
            py::kw_only(), py::arg("bounces") = 0, py::arg("scene").none(true) = py::none(),
            py::arg("albedo") = 0.5, py::arg("progress") = py::none(), py::arg("threads") = 0,
            "Irradiance of an Environment, and with scene= of the scene's own lamps and emissive\n"
            "surfaces, as the cache predicts it: free of noise, and biased where its counts are\n"
            "wrong.\n\n"
            "points: places on the set, or in the air [m], normals: towards the side that is lit;\n"
            "    (..., 3) each, broadcast; normals of any length.\n"
            "bounces: surfaces that light may meet before, or 'unlimited', by the transport that\n"
            "    the cache holds; of the last call's environment, scene, albedo and number it is\n"
            "    kept.\n"
            "scene: that was baked, whose colours light meets, whose lamps shine, and whose rays\n"
            "    see for places in the air, more than a tenth of a voxel above any surface: one\n"
            "    through the middle of each of 20,480 cells of the sphere, and 1,024 to what\n"
            "    shines. None: nothing shines but the environment, all has `albedo`, as what has\n"
            "    no material does, places within a voxel of a surface count as on it, and others\n"
            "    are refused.\n"
            "Returns float32 (..., 3), linear RGB [radiance sr]; NaN where an input is not finite\n"
            "or a zero vector. Times albedo / pi it is the radiance that a Lambertian surface\n"
            "reflects.")
        .def("operator", skyOperator, py::arg("points"), py::arg("normals"), py::kw_only(),
             py::arg("level") = 3, py::arg("bounces") = 0, py::arg("scene").none(true) = py::none(),
             py::arg("albedo") = 0.5, py::arg("progress") = py::none(), py::arg("threads") = 0,
             "What places receive of each patch of the sky, so that the irradiance under any\n"
             "sky is one product, (operator * sky.patches(level)).sum(axis=-2): that of\n"
             "irradiance(), with the light of each patch spread evenly over it. The light of the\n"
             "scene's own lamps and emissive surfaces is the same under any sky: it is not in the\n"
             "operator, and is added as irradiance() of Environment.constant(0) has it.\n\n"
             "level: of the patches, 1 to 5: 20 * 4^level over the sphere, of about 23, 11, 6, 3\n"
             "    or 1.4 degrees.\n"
             "points, normals, bounces, scene, albedo: as of irradiance().\n"
             "Returns float32 (..., patches, 3): irradiance for each unit of a patch's light;\n"
             "NaN where an input is not finite or a zero vector.");
    py::class_<EnvironmentObject, std::shared_ptr<EnvironmentObject>> environment =
        module.attr("Environment");
    environment.def("patches", patches, py::arg("level") = 3, py::kw_only(),
                    py::arg("progress") = py::none(), py::arg("threads") = 0,
                    "Light of the patches of Cache.operator(): integral of the radiance over each\n"
                    "[radiance sr], (patches, 3) float64. Those of a constant 1 are their solid\n"
                    "angles.");
    module.def("patch_directions", patchDirections, py::arg("level") = 3,
               "Unit vectors to the middles of the patches of Cache.operator(), (patches, 3).");
}

}  // namespace shadowcache::python
