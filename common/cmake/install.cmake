# What a package holds: the programs, the library with its headers, and a package config. The headers
# stand in include/shadowcache, so that #include "common/shadow_cache.h" means the same everywhere.
include(CMakePackageConfigHelpers)

set(SHADOWCACHE_CONFIG_DIR "${CMAKE_INSTALL_LIBDIR}/cmake/shadowcache")

install(TARGETS shadowcache-bake shadowcache-render shadowcache-info shadowcache-merge
    RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}")
# A list that somebody chose: what a renderer needs to open a cache, look places up and predict light.
set(SHADOWCACHE_PUBLIC_HEADERS
    base/error.h
    cache/cache_items.h
    cache/memory_use.h
    cache/patch_code.h
    cache/shadow_cache.h
    image/image.h
    image/radiance.h
    light/environment.h
    math/direction_mesh.h
    math/spherical_triangle.h
    math/vec.h
    predict/cache_preview.h
    predict/cell_light.h
    predict/cell_splits.h
    predict/item_irradiance.h
    predict/pooled_visibility.h)
set_target_properties(shadowcache_library PROPERTIES OUTPUT_NAME shadowcache EXPORT_NAME shadowcache)
target_compile_features(shadowcache_library PUBLIC cxx_std_20)
install(TARGETS shadowcache_library EXPORT shadowcache_targets
    ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}"
    LIBRARY DESTINATION "${CMAKE_INSTALL_LIBDIR}"
    INCLUDES DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/shadowcache")
foreach(header IN LISTS SHADOWCACHE_PUBLIC_HEADERS)
    cmake_path(GET header PARENT_PATH room)
    install(FILES common/${header}
        DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/shadowcache/common/${room}")
endforeach()
install(FILES "${PROJECT_BINARY_DIR}/generated/common/base/version.h"
    DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/shadowcache/common/base")
install(FILES LICENSE NOTICE DESTINATION "${CMAKE_INSTALL_DOCDIR}")

install(EXPORT shadowcache_targets NAMESPACE shadowcache:: FILE shadowcacheTargets.cmake
    DESTINATION "${SHADOWCACHE_CONFIG_DIR}")
configure_package_config_file(common/cmake/shadowcacheConfig.cmake.in
    "${PROJECT_BINARY_DIR}/shadowcacheConfig.cmake" INSTALL_DESTINATION "${SHADOWCACHE_CONFIG_DIR}")
write_basic_package_version_file("${PROJECT_BINARY_DIR}/shadowcacheConfigVersion.cmake"
    COMPATIBILITY SameMinorVersion)
install(FILES
    "${PROJECT_BINARY_DIR}/shadowcacheConfig.cmake"
    "${PROJECT_BINARY_DIR}/shadowcacheConfigVersion.cmake"
    DESTINATION "${SHADOWCACHE_CONFIG_DIR}")
