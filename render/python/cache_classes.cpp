#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "bake/library/bake_rows.h"
#include "bake/library/bake_set.h"
#include "common/base/error.h"
#include "common/base/option_checks.h"
#include "common/base/text_streams.h"
#include "common/cache/cache_items.h"
#include "common/cache/transport.h"
#include "common/predict/many_places.h"
#include "render/bounces/bounce_task.h"
#include "render/bounces/item_looks.h"
#include "render/library/option_table.h"
#include "render/python/arrays.h"
#include "render/python/classes.h"
#include "render/python/long_call.h"
#include "render/python/options.h"

namespace shadowcache::python {

namespace py = pybind11;
namespace fs = std::filesystem;

namespace {

std::shared_ptr<CacheObject> bakeScene(const SceneObject& scene, const py::object& progress,
                                       int threads, const py::kwargs& keywords) {
    BakeOptions options;
    std::optional<double> chosenSpacings;
    readKeywords("bake", keywords, bakeRows(options, chosenSpacings));
    // Without a spacing one is chosen, but 0 is none.
    if (keywords.contains("spacing") && !keywords["spacing"].is_none())
        requireRange("spacing", options.spacing, 1e-300, kMostSpacing);
    const auto set = scene.set;
    return longCall(
        progress,
        [&] {
            const BakeResult result = bakeSet(*set, options);
            std::shared_ptr<const ShadowCache> cache = makeCache(result.header, result.items);
            return std::make_shared<CacheObject>(CacheObject{std::move(cache), {}, {}});
        },
        threads);
}

std::shared_ptr<CacheObject> openCache(const fs::path& path, const py::object& memory) {
    RenderJob job;
    const std::vector<OptionRow> rows = optionRows(Part::cache, job);
    if (!memory.is_none()) readOption(*findRow(rows, "memory"), memory);
    return longCall(py::none(), [&] {
        return std::make_shared<CacheObject>(
            CacheObject{std::make_shared<const ShadowCache>(path, job.stage.memory), path, {}});
    });
}

std::uintmax_t saveCache(const CacheObject& cache, const fs::path& path) {
    requireExtension(path, ".vdb");
    const auto kept = cache.cache;
    return longCall(py::none(), [&] { return writeCache(path, kept->header(), itemsOf(*kept)); });
}

/// Columns of ItemTable::Item.
py::dtype itemType() {
    using Item = ItemTable::Item;
    py::list names, formats, offsets;
    const auto add = [&](const char* name, const char* format, std::size_t offset) {
        names.append(name);
        formats.append(format);
        offsets.append(offset);
    };
    add("voxel", "3i4", offsetof(Item, voxel));
    add("patch", "i2", offsetof(Item, patch));
    add("position", "3f4", offsetof(Item, position));
    add("normal", "3f4", offsetof(Item, normal));
    add("exposure", "f4", offsetof(Item, exposure));
    return {names, formats, offsets, sizeof(Item)};
}

py::array itemsArray(CacheObject& cache) {
    if (!cache.items) {
        const auto kept = cache.cache;
        cache.items =
            longCall(py::none(), [&] { return std::make_shared<const ItemTable>(*kept); });
    }
    const auto items = cache.items;
    using Owner = std::shared_ptr<const ItemTable>;
    const py::capsule owner(new Owner(items), [](void* kept) { delete static_cast<Owner*>(kept); });
    py::array array(itemType(), {static_cast<py::ssize_t>(items->size())}, {}, items->all().data(),
                    owner);
    array.attr("flags").attr("writeable") = false;
    return array;
}

py::object numbersOrArray(const py::array& array) {
    return array.ndim() == 0 ? py::object(array.attr("item")()) : py::object(array);
}

py::object visibility(const CacheObject& cache, const py::object& points, const py::object& normals,
                      const py::object& directions, const py::object& progress, int threads) {
    const Broadcast all({{"points", points}, {"normals", normals}, {"directions", directions}});
    const auto kept = cache.cache;
    py::array_t<float> out = newArray<float>(all.shape());
    const std::span<float> shares = valuesOf<float>(out);
    runLong(
        progress,
        [&] {
            forEachPart(all, kMostOfPart, [&](std::size_t first, const auto& vectors) {
                visibilityAt(*kept, {vectors[0], vectors[1]}, vectors[2],
                             shares.subspan(first, vectors[0].size()));
            });
        },
        threads);
    return numbersOrArray(out);
}

/// A number of bounces, or "unlimited".
using Bounces = std::variant<int, std::string>;

int bouncesOf(const Bounces& bounces) {
    const auto* number = std::get_if<int>(&bounces);
    if (number && *number >= 0 && *number <= kMostBounces) return *number;
    if (!number && std::get<std::string>(bounces) == "unlimited") return kUnlimitedBounces;
    throw py::value_error("bounces: expected 0 to " + std::to_string(kMostBounces) +
                          ", or 'unlimited'");
}

/// Solves the light that bounces, unless that is `wanted` already. Needs no lock.
void solveLight(const ShadowCache& cache, SolvedLight& wanted) {
    if (wanted.solve) return;
    if (!wanted.items) wanted.items = std::make_shared<const ItemTable>(cache);
    const std::optional<Transport> transport = readTransport(cache, *wanted.items);
    if (!transport)
        throw Error(
            "cache: holds no transport, by which bounces are predicted: bake with "
            "transport=True");
    const PlainLook plain{wanted.albedo};
    const std::vector<ItemLook> looks =
        wanted.set ? looksOf(wanted.set->scene, *wanted.items, plain)
                   : std::vector<ItemLook>(wanted.items->size(), ItemLook{.albedo = plain.albedo});
    wanted.solve = std::make_shared<const BounceSolve>(cache, *wanted.items, *transport,
                                                       *wanted.light, looks, wanted.bounces);
}

/// What is asked for, with what the cache's last call has of it.
SolvedLight wantedOf(const CacheObject& cache, const EnvironmentObject& environment,
                     const SceneObject* scene, const Bounces& bounces, const py::object& albedo) {
    SolvedLight wanted{environment.light,
                       scene ? scene->set : nullptr,
                       Rgb(colorOf(albedo, "albedo")),
                       bouncesOf(bounces),
                       cache.items,
                       nullptr};
    for (int k = 0; k < 3; ++k)
        if (!(wanted.albedo[k] >= 0 && wanted.albedo[k] <= 1))
            throw py::value_error("albedo: expected 0 to 1");
    if (wanted.set && wanted.set->fingerprint != cache.cache->header().fingerprint)
        throw Error("scene: not the one that the cache was baked for (its fingerprint differs)");
    const SolvedLight& last = cache.solved;
    if (last.light == wanted.light && last.set == wanted.set && last.albedo == wanted.albedo &&
        last.bounces == wanted.bounces)
        wanted = last;
    return wanted;
}

py::array irradiance(CacheObject& cache, const py::object& points, const py::object& normals,
                     const EnvironmentObject& environment, const Bounces& bounces,
                     const SceneObject* scene, const py::object& albedo, const py::object& progress,
                     int threads) {
    const Broadcast all({{"points", points}, {"normals", normals}});
    const auto kept = cache.cache;
    SolvedLight wanted = wantedOf(cache, environment, scene, bounces, albedo);
    py::array_t<float> out = newArray<float>(all.shape({3}));
    const std::span<Rgb> values = valuesOf<Rgb>(out);
    runLong(
        progress,
        [&] {
            if (wanted.bounces != 0) solveLight(*kept, wanted);
            const CachePreview preview(*wanted.light, kept->header().tiers());
            forEachPart(all, kMostOfPart, [&](std::size_t first, const auto& vectors) {
                const Places places{vectors[0], vectors[1]};
                const auto part = values.subspan(first, places.size());
                if (wanted.bounces == 0)
                    irradianceAt(*kept, preview, places, part);
                else
                    irradianceAt(*kept, preview, *wanted.solve, wanted.bounces, places, part);
            });
        },
        threads);
    if (wanted.bounces != 0) {
        cache.items = wanted.items;
        cache.solved = std::move(wanted);
    }
    return out;
}

py::dict headerOf(const CacheObject& cache) {
    const CacheHeader& header = cache.cache->header();
    using namespace py::literals;
    return py::dict("level"_a = header.level, "adaptive"_a = header.adaptive,
                    "spacing"_a = header.spacing, "rays"_a = header.rays(),
                    "seeds"_a = header.seeds(), "up"_a = header.upAxis, "unit"_a = header.unit,
                    "fingerprint"_a = fingerprintText(header.fingerprint),
                    "version"_a = header.version);
}

std::string reprOf(const CacheObject& cache) {
    TextWriter text;
    text << "<shadowcache.Cache: " << cache.cache->itemCount() << " items, spacing "
         << cache.cache->header().spacing << " m, "
         << (cache.path.empty() ? "in memory" : cache.path.string()) << ">";
    return text.str();
}

}  // namespace

void defineCache(py::module_& module) {
    py::class_<CacheObject, std::shared_ptr<CacheObject>>(
        module, "Cache",
        "Which directions reach the sky, for every place near the surfaces of a set.")
        .def_static(
            "open", openCache, py::arg("path"), py::kw_only(), py::arg("memory") = py::none(),
            "Reads a cache file (.vdb) into memory; with memory='4G' page by page as it is\n"
            "needed, of which so much stays.")
        .def("save", saveCache, py::arg("path"),
             "Writes the cache to a file (.vdb), as shadowcache-bake does, and returns its bytes.")
        .def_property_readonly(
            "path",
            [](const CacheObject& c) {
                return c.path.empty() ? std::nullopt : std::optional(c.path.string());
            },
            "The file that it was opened from; None of a bake in memory.")
        .def_property_readonly(
            "spacing", [](const CacheObject& c) { return c.cache->header().spacing; },
            "Side of a voxel [m].")
        .def_property_readonly("header", headerOf, "What the cache records of its bake.")
        .def_property_readonly(
            "nbytes", [](const CacheObject& c) { return c.cache->memoryBytes(); },
            "Bytes of memory that it takes.")
        .def("__len__", [](const CacheObject& c) { return c.cache->itemCount(); })
        .def("items", itemsArray,
             "The items, a read-only structured array of shape (len(cache),) that shares the\n"
             "cache's memory. Fields: 'voxel' (3 int32); 'patch' (int16, side and layer, packed);\n"
             "'position' (3 float32, mean point from the voxel's middle, in spacings); 'normal'\n"
             "(3 float32, unit); 'exposure' (float32, in (0, 1]: exposed share of its surface).\n"
             "World positions are (voxel + position) * cache.spacing.")
        .def(
            "visibility", visibility, py::arg("points"), py::arg("normals"), py::arg("directions"),
            py::kw_only(), py::arg("progress") = py::none(), py::arg("threads") = 0,
            "Visible share of the sky around directions, as the cache predicts it without rays.\n\n"
            "points: places on the set [m], normals: towards the side that is lit, directions:\n"
            "    (..., 3) each, broadcast; normals and directions of any length.\n"
            "Returns float32 in [0, 1] of the common shape (...); NaN where the cache has no item\n"
            "or an input is not finite or a zero vector.")
        .def(
            "irradiance", irradiance, py::arg("points"), py::arg("normals"), py::arg("environment"),
            py::kw_only(), py::arg("bounces") = 0, py::arg("scene").none(true) = py::none(),
            py::arg("albedo") = 0.5, py::arg("progress") = py::none(), py::arg("threads") = 0,
            "Irradiance of an Environment, as the cache predicts it without rays: free of noise,\n"
            "and biased where its counts are wrong.\n\n"
            "points: places on the set [m], normals: towards the side that is lit; (..., 3) each,\n"
            "    broadcast; normals of any length.\n"
            "bounces: surfaces that light may meet before, or 'unlimited', by the transport that "
            "the\n"
            "    cache holds; of the last call's environment, scene, albedo and number it is "
            "kept.\n"
            "scene: that was baked, whose colours and lamps light meets; None: all of it has\n"
            "    `albedo`, as what has no material does.\n"
            "Returns float32 (..., 3), linear RGB [radiance sr]; NaN where the cache has no item\n"
            "or an input is not finite or a zero vector. Times albedo / pi it is the radiance "
            "that\n"
            "a Lambertian surface reflects.")
        .def("__repr__", reprOf);
    BakeOptions standard;
    std::optional<double> none;
    static const std::string kBakeHelp =
        "Bakes a Scene, and returns its Cache in memory: the items of shadowcache-bake.\n\n"
        "Options, with their standard values:\n" +
        helpOf(bakeRows(standard, none));
    module.def("bake", bakeScene, py::arg("scene"), py::kw_only(), py::arg("progress") = py::none(),
               py::arg("threads") = 0, kBakeHelp.c_str());
}

}  // namespace shadowcache::python
