#pragma once

#include <pybind11/pybind11.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "common/cache/item_table.h"
#include "common/cache/shadow_cache.h"
#include "common/image/radiance_image.h"
#include "common/light/environment.h"
#include "common/shot/loaded_set.h"

namespace shadowcache::python {

// What the classes of the module hold. All is shared and immutable, so that calls of several
// threads may go on at once, and outlive the objects that they were made with.

/// Scene.
struct SceneObject {
    std::shared_ptr<const LoadedSet> set;
    std::vector<std::filesystem::path> files;  ///< none of arrays
};

/// Cache.
struct CacheObject {
    std::shared_ptr<const ShadowCache> cache;
    std::filesystem::path path;              ///< empty: baked, in no file
    std::shared_ptr<const ItemTable> items;  ///< null until it is wanted
};

/// Environment.
struct EnvironmentObject {
    std::string name;
    std::shared_ptr<const RadianceImage> map;
    std::shared_ptr<const EnvironmentMap> tables;  ///< of `map`; turned, they are still its
    double rotation = 0;                           ///< [degrees]
    std::shared_ptr<const Environment> light;
};

void defineScene(pybind11::module_& module);
void defineCache(pybind11::module_& module);
void defineEnvironment(pybind11::module_& module);
void defineSampler(pybind11::module_& module);  ///< after the two
void defineRender(pybind11::module_& module);

}  // namespace shadowcache::python
