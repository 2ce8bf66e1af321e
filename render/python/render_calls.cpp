#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common/image/exr.h"
#include "common/shot/picture_view.h"
#include "render/frame/aov_channels.h"
#include "render/library/lit_stage.h"
#include "render/library/option_table.h"
#include "render/library/picture_options.h"
#include "render/library/stale_cache.h"
#include "render/python/arrays.h"
#include "render/python/classes.h"
#include "render/python/long_call.h"
#include "render/python/options.h"

namespace shadowcache::python {

namespace py = pybind11;
namespace fs = std::filesystem;

namespace {

/// The channels of one name.
struct Layer {
    std::string name;
    std::vector<const Channel*> parts;
};

/// Channels by the names before their last dots, in the order of their letters' meaning.
///
/// @param groups  names of light groups: their layers are called light:NAME
std::vector<Layer> layersOf(const std::vector<Channel>& channels,
                            const std::vector<std::string>& groups) {
    std::vector<Layer> layers;
    for (const Channel& channel : channels) {
        const std::size_t dot = channel.name.rfind('.');
        const bool isColor = std::string("RGBA").find(channel.name) != std::string::npos;
        std::string name = isColor ? "color" : channel.name.substr(0, dot);
        if (std::ranges::find(groups, name) != groups.end()) name = "light:" + name;
        auto found = std::ranges::find(layers, name, &Layer::name);
        if (found == layers.end()) found = layers.insert(found, {name, {}});
        found->parts.push_back(&channel);
    }
    const auto rank = [](const Channel* channel) {
        return std::string("RGBAXYZ").find(channel->name.back());
    };
    for (Layer& layer : layers) std::ranges::sort(layer.parts, {}, rank);
    return layers;
}

py::dict picturesOf(const std::vector<Channel>& channels, const std::vector<std::string>& groups,
                    int width, int height) {
    py::dict pictures;
    for (const Layer& layer : layersOf(channels, groups)) {
        const std::size_t count = layer.parts.size();
        std::vector<float> values(layer.parts.front()->values.size() * count);
        for (std::size_t k = 0; k < count; ++k)
            for (std::size_t i = 0; i < layer.parts[k]->values.size(); ++i)
                values[i * count + k] = layer.parts[k]->values[i];
        Shape shape{height, width};
        if (count > 1) shape.push_back(static_cast<py::ssize_t>(count));
        pictures[py::str(layer.name)] = arrayOf<float>(shape, std::move(values));
    }
    return pictures;
}

py::dict readPicture(const fs::path& path) {
    const ExrFile file = longCall(py::none(), [&] { return readExr(path); });
    const auto named = file.metadata.find("shadowcache:" + std::string(kGroupsKey));
    return picturesOf(
        file.channels,
        named == file.metadata.end() ? std::vector<std::string>() : groupsOf(named->second),
        file.width, file.height);
}

/// The options of render(), written to a job.
std::vector<OptionRow> pictureRows(RenderJob& job) {
    std::vector<OptionRow> rows = optionRows(Part::size, job);
    for (const Part part : {Part::picture, Part::cache})
        for (const OptionRow& row : optionRows(part, job))
            if (part == Part::picture || row.name == "stale-ok") rows.push_back(row);
    return rows;
}

/// What is said of a picture, for people. To be called with the interpreter's lock.
void warn(const std::vector<std::string>& notes) {
    for (const std::string& note : notes)
        if (PyErr_WarnEx(PyExc_UserWarning, note.c_str(), 1) != 0) throw py::error_already_set();
}

/// Lights the stage, unless it is lit so already. To be called without the interpreter's lock.
void light(LitShot& shot, const PictureOptions& asked, const PictureSettings& settings) {
    const LightingOptions wanted = lightingOf(asked, settings);
    if (shot.stage && &shot.stage->entry() == &settings.estimator &&
        isSame(shot.stage->options(), wanted))
        return;
    const auto stage =
        std::make_shared<LitStage>(shot.set->scene, shot.cache.get(), settings.estimator, wanted);
    stage->requirePrediction(settings.options);
    stage->setEnvironment(*shot.light);
    shot.stage = stage;
}

/// The channels of a picture, and the names of its light groups.
struct Rendered {
    std::vector<Channel> channels;
    std::vector<std::string> groups;
};

/// To be called without the interpreter's lock.
Rendered renderChannels(LitShot& shot, const CameraMove& camera, int frame,
                        const PictureOptions& asked, std::vector<std::string>& notes) {
    const PictureSettings settings = resolve(asked, shot.cache != nullptr, shot.set->options.gloss);
    light(shot, asked, settings);
    if (!shot.stage->note().empty()) notes.push_back(inPythonsWords(shot.stage->note()));
    const std::string aspect =
        aspectNote(camera.middle(), settings.options.width, settings.options.height);
    if (!aspect.empty()) notes.push_back("camera: " + aspect);
    RenderStats stats;
    const Picture picture = shot.stage->plan(camera, frame, settings.options, stats,
                                             asked.rays.targetError.value_or(0));
    const Film film = picture.film(stats);
    return {channels(film, asked.aovs), film.groups};
}

/// A shot of these, lit as the cache's last one if that was of them.
LitShot shotOf(const SceneObject& scene, const CacheObject* cache,
               const EnvironmentObject& environment) {
    if (cache && cache->lit.set == scene.set && cache->lit.light == environment.light)
        return cache->lit;
    return {scene.set, cache ? cache->cache : nullptr, environment.light, nullptr};
}

py::dict renderScene(const SceneObject& scene, const std::shared_ptr<CacheObject>& cache,
                     const EnvironmentObject& environment, const CameraMove& camera, int frame,
                     const py::object& progress, int threads, const py::kwargs& options) {
    RenderJob job;
    readKeywords("render", options, pictureRows(job));
    LitShot shot = shotOf(scene, cache.get(), environment);
    std::vector<std::string> notes;
    if (cache)
        isStale(cache->cache->header(), scene.set->fingerprint, "cache", job.stage.staleOk,
                [&](const std::string& text, NoteKind) { notes.push_back(text); });
    const Rendered all = longCall(
        progress, [&] { return renderChannels(shot, camera, frame, job.picture, notes); }, threads);
    if (cache) cache->lit = std::move(shot);
    warn(notes);
    const FilmRectangle region = job.picture.options.region();
    return picturesOf(all.channels, all.groups, region.width, region.height);
}

}  // namespace

void defineRender(py::module_& module) {
    RenderJob standard;
    static const std::string kRenderHelp =
        "Renders a Scene as a Camera sees it: the pixels of shadowcache-render.\n\n"
        "cache: of the scene; None: rendered without one. What it predicts of the light is kept "
        "for\n"
        "    the next call with the same scene, environment and look. frame: number of the frame, "
        "which\n"
        "    chooses its random numbers with the seed.\n"
        "Returns a dict of float32 arrays: 'color' (height, width, 3), linear radiance, with\n"
        "transparent=True (height, width, 4), and each of the aovs, (height, width, 3) or\n"
        "(height, width); with light_groups the light of each as 'light:NAME', which together are\n"
        "'color'. An AOV is the mean over the camera rays of a pixel that met something, "
        "where\n"
        "several surfaces meet as well: depth and position there lie between them, and normals "
        "are\n"
        "shorter than 1. camera_rays=1 with filter='box' has those of one ray each.\n\n"
        "Options, with their standard values:\n" +
        helpOf(pictureRows(standard));
    module.def("render", renderScene, py::arg("scene"), py::arg("cache").none(true),
               py::arg("environment"), py::arg("camera"), py::kw_only(), py::arg("frame") = 1,
               py::arg("progress") = py::none(), py::arg("threads") = 0, kRenderHelp.c_str());
    module.def("read_exr", readPicture, py::arg("path"),
               "The pictures of an EXR file of shadowcache-render, named as render() names them.");
}

}  // namespace shadowcache::python
