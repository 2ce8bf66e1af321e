#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bake/library/bake_rows.h"
#include "bake/library/bake_set.h"
#include "bake/library/bake_views.h"
#include "common/base/error.h"
#include "common/base/option_checks.h"
#include "common/base/text_streams.h"
#include "common/cache/cache_items.h"
#include "common/predict/many_places.h"
#include "common/shot/set_options.h"
#include "render/library/option_table.h"
#include "render/python/arrays.h"
#include "render/python/classes.h"
#include "render/python/long_call.h"
#include "render/python/options.h"
#include "render/sensors/air_irradiance.h"

namespace shadowcache::python {

namespace py = pybind11;
namespace fs = std::filesystem;

namespace {

/// Pictures that a bake is for, with their cameras.
struct BakedViews {
    std::vector<CameraMove> cameras;
    std::array<int, 2> size{960, 540};
    int margin = 0;
};

/// The cameras of bake(). @throws TypeError, ValueError
std::vector<CameraMove> camerasOf(const py::object& cameras) {
    std::vector<CameraMove> all;
    if (cameras.is_none()) return all;
    if (!py::isinstance<py::sequence>(cameras))
        throw py::type_error("cameras: expected a list of Camera");
    for (const py::handle camera : py::reinterpret_borrow<py::sequence>(cameras)) {
        if (!py::isinstance<CameraMove>(camera))
            throw py::type_error("cameras: expected a list of Camera");
        all.push_back(camera.cast<CameraMove>());
    }
    if (all.empty()) throw py::value_error("cameras: expected one or more");
    return all;
}

/// The options of bake() for the pictures of a shot.
std::vector<OptionRow> viewRows(BakedViews& views) {
    return {sizeRow(views.size[0], views.size[1]), marginRow(views.margin)};
}

/// All options of bake().
std::vector<OptionRow> rowsOfBake(BakeOptions& options, std::optional<double>& chosenSpacings,
                                  BakedViews& views) {
    std::vector<OptionRow> rows = bakeRows(options, chosenSpacings);
    for (const OptionRow& row : viewRows(views)) rows.push_back(row);
    return rows;
}

std::shared_ptr<CacheObject> bakeScene(const SceneObject& scene, const py::object& cameras,
                                       const py::object& progress, int threads,
                                       const py::kwargs& keywords) {
    requireNoFrame(*scene.set, "bake");
    BakeOptions options;
    std::optional<double> chosenSpacings;
    BakedViews views{.cameras = camerasOf(cameras)};
    readKeywords("bake", keywords, rowsOfBake(options, chosenSpacings, views));
    if (views.cameras.empty())
        for (const OptionRow& row : viewRows(views))
            if (keywords.contains(row.name) && !keywords[row.name.c_str()].is_none())
                throw py::type_error(row.name + ": expected with cameras");
    const bool isLevelGiven = keywords.contains("level") && !keywords["level"].is_none();
    // Without a spacing one is chosen, but 0 is none.
    if (keywords.contains("spacing") && !keywords["spacing"].is_none())
        requireRange("spacing", options.spacing, 1e-300, kMostSpacing);
    const auto set = scene.set;
    return longCall(
        progress,
        [&] {
            const BakeResult result =
                views.cameras.empty()
                    ? bakeSet(*set, options)
                    : bakeViews(*set, options, {views.cameras, views.size, views.margin},
                                isLevelGiven);
            std::shared_ptr<const ShadowCache> cache = makeCache(result.header, result.items);
            return std::make_shared<CacheObject>(CacheObject{std::move(cache), {}, {}, {}});
        },
        threads);
}

std::shared_ptr<CacheObject> openCache(const fs::path& path, const py::object& memory) {
    RenderJob job;
    const std::vector<OptionRow> rows = optionRows(Part::cache, job);
    if (!memory.is_none()) readOption(*findRow(rows, "memory"), memory);
    std::optional<std::string> budget;
    if (!memory.is_none()) budget = py::str(memory);
    return longCall(py::none(), [&] {
        return std::make_shared<CacheObject>(CacheObject{
            std::make_shared<const ShadowCache>(path, job.stage.memory), path, budget, {}});
    });
}

py::tuple stateOfCache(const CacheObject& cache) {
    return py::make_tuple(pickledPath(cache.path, "Cache"), cache.memory,
                          cache.cache->header().fingerprint, cache.cache->itemCount());
}

std::shared_ptr<CacheObject> cacheOf(const py::tuple& state) {
    const auto path = state[0].cast<std::string>();
    auto cache = openCache(path, state[1]);
    requireUnchanged(cache->cache->header().fingerprint == state[2].cast<std::uint64_t>() &&
                         cache->cache->itemCount() == state[3].cast<std::size_t>(),
                     path);
    return cache;
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
                      const py::object& directions, const SceneObject* scene,
                      const py::object& progress, int threads) {
    const Broadcast all({{"points", points}, {"normals", normals}, {"directions", directions}});
    const auto kept = cache.cache;
    const auto set = scene ? scene->set : nullptr;
    requireSetOf(*kept, set.get());
    py::array_t<float> out = newArray<float>(all.shape());
    const std::span<float> shares = valuesOf<float>(out);
    runLong(
        progress,
        [&] {
            forEachPart(all, kMostOfPart, [&](std::size_t first, const auto& vectors) {
                const Places places{vectors[0], vectors[1]};
                const std::span<float> part = shares.subspan(first, places.size());
                visibilityAt(*kept, places, vectors[2], part);
                std::vector<std::size_t> inAir =
                    placesInAir(set ? &set->scene : nullptr, kept->header().spacing, places, part);
                std::erase_if(inAir, [&](std::size_t i) { return !isDirection(vectors[2][i]); });
                if (inAir.empty()) return;
                if (!set) refuseInAir(places.positions[inAir.front()]);
                visibilityInAir(set->scene, places, vectors[2], inAir, part);
            });
        },
        threads);
    return numbersOrArray(out);
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

std::string reprOfCache(const CacheObject& cache) {
    TextWriter text;
    text << "<shadowcache.Cache: " << cache.cache->itemCount() << " items, spacing "
         << cache.cache->header().spacing << " m, "
         << (cache.path.empty() ? "in memory" : cache.path.string()) << ">";
    return text.str();
}

}  // namespace

void requireSetOf(const ShadowCache& cache, const LoadedSet* set) {
    if (!set) return;
    requireNoFrame(*set, "Cache");
    if (set->fingerprint != cache.header().fingerprint)
        throw Error("scene: not the one that the cache was baked for (its fingerprint differs)");
}

void defineCache(py::module_& module) {
    py::class_<CacheObject, std::shared_ptr<CacheObject>>(
        module, "Cache",
        "Which directions reach the sky, for every place near the surfaces of a set. Pickled by\n"
        "its file.")
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
            py::kw_only(), py::arg("scene").none(true) = py::none(),
            py::arg("progress") = py::none(), py::arg("threads") = 0,
            "Visible share of the sky around directions, as the cache predicts it without rays.\n\n"
            "points: places on the set, or in the air [m], normals: towards the side that is lit,\n"
            "    directions: (..., 3) each, broadcast; normals and directions of any length.\n"
            "scene: that was baked, whose rays see for places in the air: 1 where one along the\n"
            "    direction reaches the sky, else 0. None: places within a voxel of a surface "
            "count\n"
            "    as on it, and others are refused.\n"
            "Returns float32 in [0, 1] of the common shape (...); NaN where an input is not "
            "finite\n"
            "or a zero vector.")
        .def(py::pickle(&stateOfCache, &cacheOf))
        .def("__repr__", reprOfCache);
    BakeOptions standard;
    std::optional<double> none;
    BakedViews views;
    static const std::string kBakeHelp =
        "Bakes a Scene, and returns its Cache in memory: the items of shadowcache-bake.\n\n"
        "cameras: bakes only what the pictures of these Cameras look up, a list; with `size`,\n"
        "    theirs, and `margin`. None: the whole set.\n\n"
        "Options, with their standard values:\n" +
        helpOf(rowsOfBake(standard, none, views));
    module.def("bake", bakeScene, py::arg("scene"), py::kw_only(), py::arg("cameras") = py::none(),
               py::arg("progress") = py::none(), py::arg("threads") = 0, kBakeHelp.c_str());
}

}  // namespace shadowcache::python
