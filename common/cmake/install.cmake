# What a package holds: the programs, the library with its headers, and a package config. The headers
# stand in include/shadowcache, so that #include "common/shadow_cache.h" means the same everywhere.
include(CMakePackageConfigHelpers)

set(SHADOWCACHE_CONFIG_DIR "${CMAKE_INSTALL_LIBDIR}/cmake/shadowcache")

install(TARGETS shadowcache-bake shadowcache-render shadowcache-info shadowcache-merge
    RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}")
set_target_properties(shadowcache_common PROPERTIES EXPORT_NAME common)
target_compile_features(shadowcache_common PUBLIC cxx_std_20)
install(TARGETS shadowcache_common EXPORT shadowcache_targets
    ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}"
    LIBRARY DESTINATION "${CMAKE_INSTALL_LIBDIR}"
    INCLUDES DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/shadowcache")
install(DIRECTORY common/ DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/shadowcache/common"
    FILES_MATCHING PATTERN "*.h"
    PATTERN "cmake" EXCLUDE
    PATTERN "cache_grids.h" EXCLUDE  # the types of OpenVDB and Embree stay inside
    PATTERN "cache_pages.h" EXCLUDE
    PATTERN "embree_scene.h" EXCLUDE
    PATTERN "leaf_view.h" EXCLUDE
    PATTERN "paged_leaves.h" EXCLUDE
    PATTERN "point_layout.h" EXCLUDE
    PATTERN "vdb_archive.h" EXCLUDE
    PATTERN "command_*.h" EXCLUDE)  # of the programs alone
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
