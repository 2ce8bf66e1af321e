#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <exception>
#include <filesystem>
#include <utility>

#include "common/base/error.h"
#include "common/base/option_checks.h"
#include "common/base/parallel.h"
#include "common/base/version.h"
#include "render/python/classes.h"
#include "render/python/options.h"

namespace shadowcache::python {

namespace {

constexpr const char* kModuleDoc =
    "Bakes the visibility of a static set once, and renders it under any HDRI.\n\n"
    "    scene = shadowcache.load_set('room.glb')\n"
    "    cache = shadowcache.bake(scene)\n"
    "    sky = shadowcache.Environment.load('sky.exr')\n"
    "    camera = shadowcache.Camera(eye=(2, 1.6, 3), look_at=(0, 1, 0))\n"
    "    color = shadowcache.render(scene, cache, sky, camera)['color']\n\n"
    "World space is right-handed with +Y up, in metres. Radiance is linear; irradiance is\n"
    "radiance times steradians. Arrays of places and directions have a last axis of 3, of any\n"
    "real dtype, and are broadcast against each other. Long calls let other threads run, take\n"
    "progress=f, called as f(task, done, total), and threads=N, the threads to work on at most\n"
    "(0: those of set_threads()), and end on Ctrl-C. Refused inputs raise Error, or ValueError\n"
    "and TypeError for arrays.";

}  // namespace

}  // namespace shadowcache::python

/// What is in the module.
static void define(pybind11::module_& module) {
    namespace py = pybind11;
    module.doc() = shadowcache::python::kModuleDoc;
    module.attr("__version__") = shadowcache::kVersion;
    static auto& error = *new py::exception<shadowcache::Error>(
        module, "Error", PyExc_RuntimeError);  // outlives Python
    error.doc() =
        "An input or a file that is refused; the text names it, what was found and expected.";
    py::register_exception_translator([](std::exception_ptr thrown) {
        try {
            std::rethrow_exception(std::move(thrown));
        } catch (const shadowcache::Error& e) {
            error(shadowcache::python::inPythonsWords(e.what()).c_str());
        } catch (const std::filesystem::filesystem_error& e) {  // as the size of a device
            error((e.path1().string() + ": " + e.code().message()).c_str());
        }
    });
    module.def(
        "set_threads",
        [](int threads) {
            shadowcache::requireRange("threads", threads, 0, shadowcache::kMaxThreads);
            shadowcache::setThreadCount(threads);
        },
        py::arg("threads"), "Limits all later calls together to so many threads; 0: every core.");
    shadowcache::python::defineCamera(module);
    shadowcache::python::defineScene(module);
    shadowcache::python::defineRays(module);
    shadowcache::python::defineLamps(module);
    shadowcache::python::defineCache(module);
    shadowcache::python::defineEnvironment(module);
    shadowcache::python::defineIrradiance(module);
    shadowcache::python::defineSampler(module);
    shadowcache::python::defineRender(module);
}

/// As PYBIND11_MODULE, which waits for ever where the first import is another interpreter's:
/// pybind11 2.10 asks for the main interpreter's lock then, with its own held.
// NOLINTNEXTLINE(readability-identifier-naming): the name that Python wants
extern "C" PYBIND11_EXPORT PyObject* PyInit_shadowcache() {
    if (PyInterpreterState_Get() != PyInterpreterState_Main()) {
        PyErr_SetString(
            PyExc_ImportError,
            "shadowcache: a sub-interpreter cannot import it; use a process (multiprocessing)");
        return nullptr;
    }
    PYBIND11_CHECK_PYTHON_VERSION
    PYBIND11_ENSURE_INTERNALS_READY
    static pybind11::module_::module_def definition;
    auto module = pybind11::module_::create_extension_module("shadowcache", nullptr, &definition);
    try {
        define(module);
        return module.ptr();
    }
    PYBIND11_CATCH_INIT_EXCEPTIONS
}
