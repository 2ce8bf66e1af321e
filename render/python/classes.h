#pragma once

#include <pybind11/pybind11.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/cache/item_table.h"
#include "common/cache/shadow_cache.h"
#include "common/image/radiance_image.h"
#include "common/light/environment.h"
#include "common/predict/bounce_solve.h"
#include "common/shot/loaded_set.h"
#include "render/library/lit_stage.h"

namespace shadowcache::python {

// What the classes of the module hold. All is shared and immutable, so that calls of several
// threads may go on at once, and outlive the objects that they were made with.

/// Lamps.
struct LampsObject {
    std::vector<Lamp> lamps;  ///< in world space
};

/// Scene.
struct SceneObject {
    std::shared_ptr<const LoadedSet> set;
    std::vector<std::filesystem::path> files;  ///< none of arrays
    pybind11::dict options = {};               ///< that it was loaded with
    LampsObject lamps = {};                    ///< that with_lamps() put into the set
};

/// The light that bounces under an environment, with what it is of.
struct SolvedLight {
    std::shared_ptr<const Environment> light;
    std::shared_ptr<const LoadedSet> set;  ///< whose looks its surfaces have; null: all the same
    Rgb albedo{0, 0, 0};                   ///< of what has no material
    int bounces = 0;
    std::shared_ptr<const ItemTable> items;
    std::shared_ptr<const std::vector<ItemLook>> looks;
    std::shared_ptr<const BounceSolve> solve;
};

/// What shines in a set, as a cache counts it.
struct OwnLight {
    std::shared_ptr<const LoadedSet> set;   ///< null: none is known
    std::shared_ptr<const SetLight> light;  ///< null: nothing shines
};

/// A stage that is lit for pictures, with what it refers to: what render() predicts of a set and
/// its light whatever the camera.
struct LitShot {
    std::shared_ptr<const LoadedSet> set;
    std::shared_ptr<const ShadowCache> cache;
    std::shared_ptr<const Environment> light;
    std::shared_ptr<const LitStage> stage;
};

/// Cache.
struct CacheObject {
    std::shared_ptr<const ShadowCache> cache;
    std::filesystem::path path;              ///< empty: baked, in no file
    std::optional<std::string> memory = {};  ///< its budget, as open() takes it
    std::shared_ptr<const ItemTable> items;  ///< null until it is wanted
    SolvedLight solved = {};                 ///< that irradiance() wanted last
    LitShot lit = {};                        ///< that render() wanted last
    OwnLight own = {};                       ///< that irradiance() wanted last
};

/// Environment.
struct EnvironmentObject {
    std::string name;
    std::shared_ptr<const RadianceImage> map;
    std::shared_ptr<const EnvironmentMap> tables;  ///< of `map`; turned, they are still its
    Turn turn = {};                                ///< of the map, before `rotation`
    double rotation = 0;                           ///< about +Y [degrees]
    Rgb gain{1.0f};                                ///< times the map
    std::shared_ptr<const Environment> light = {};
    std::filesystem::path path = {};  ///< empty: of no file
};

/// The state of an object of a file: what another process opens again.
///
/// @param what  of the object in messages
/// @throws Error for one that is in no file
std::string pickledPath(const std::filesystem::path& path, const char* what);
/// Whether an object that was opened again is still the one that was pickled.
/// @throws Error naming its file
void requireUnchanged(bool same, const std::string& path);

/// @param call  of Python, in messages
/// @throws Error if at_frame() made the set
void requireNoFrame(const LoadedSet& set, const char* call);

/// @param set  may be null
/// @throws Error unless the cache was baked for it, and nothing in it moves
void requireSetOf(const ShadowCache& cache, const LoadedSet* set);

// Help and messages have Python's names of classes that are there already.
void defineCamera(pybind11::module_& module);
void defineScene(pybind11::module_& module);  ///< after Camera
void defineCache(pybind11::module_& module);
void defineEnvironment(pybind11::module_& module);
void defineIrradiance(pybind11::module_& module);  ///< after the two
void defineSampler(pybind11::module_& module);     ///< after the two
void defineRays(pybind11::module_& module);        ///< after Scene
void defineLamps(pybind11::module_& module);       ///< likewise
void defineRender(pybind11::module_& module);

}  // namespace shadowcache::python
