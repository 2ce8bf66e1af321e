# The Debian package, made in a build folder by `cpack -G DEB`: what `cmake --install` installs, and the Python module
# if it is built.
set(CPACK_PACKAGE_NAME shadowcache)
set(CPACK_PACKAGE_VENDOR "Shadowcache")
set(CPACK_PACKAGE_CONTACT "Shadowcache <shadowcache@localhost>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION "Programs that bake the visibility of a static set into an OpenVDB file and
 render it under any HDRI, libraries that look caches up, and a Python module.")
# What programs that link the libraries need (docs/api.md).
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "libopenvdb-dev, libopenexr-dev, libfmt-dev, libembree-dev, blender")
set(CPACK_INSTALL_CMAKE_PROJECTS "${PROJECT_BINARY_DIR};${PROJECT_NAME};ALL;/")
if(SHADOWCACHE_PYTHON)
    # The module is for one version of Python.
    find_package(Python 3.9 COMPONENTS Interpreter REQUIRED)
    math(EXPR next "${Python_VERSION_MINOR} + 1")
    set(CPACK_DEBIAN_PACKAGE_DEPENDS "python3 (>= ${Python_VERSION_MAJOR}.${Python_VERSION_MINOR}), python3 (<< ${Python_VERSION_MAJOR}.${next}), python3-numpy")
    set(CPACK_DEBIAN_PACKAGE_RECOMMENDS python3-matplotlib)
    list(APPEND CPACK_INSTALL_CMAKE_PROJECTS "${PROJECT_BINARY_DIR};${PROJECT_NAME};debian;/")
endif()
include(CPack)
