# What a package holds: the programs, the libraries with their public headers (common/CMakeLists.txt,
# render/CMakeLists.txt), and a package config. The headers are in include/shadowcache, so that
# #include "common/cache/shadow_cache.h" means the same everywhere.
include(CMakePackageConfigHelpers)

set(SHADOWCACHE_CONFIG_DIR "${CMAKE_INSTALL_LIBDIR}/cmake/shadowcache")

install(TARGETS shadowcache-bake shadowcache-render shadowcache-info shadowcache-merge
        shadowcache-farm
    RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}")
set_target_properties(shadowcache_library PROPERTIES OUTPUT_NAME shadowcache EXPORT_NAME shadowcache)
install(TARGETS shadowcache_library EXPORT shadowcache_targets
    ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}"
    LIBRARY DESTINATION "${CMAKE_INSTALL_LIBDIR}"
    FILE_SET generated DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/shadowcache"
    FILE_SET HEADERS DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/shadowcache")
set_target_properties(shadowcache_render_component PROPERTIES
    OUTPUT_NAME shadowcache-render EXPORT_NAME render)
install(TARGETS shadowcache_render_component EXPORT shadowcache_render_targets
    ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}"
    FILE_SET HEADERS DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/shadowcache")
install(FILES LICENSE NOTICE DESTINATION "${CMAKE_INSTALL_DOCDIR}")
install(DIRECTORY docs/examples DESTINATION "${CMAKE_INSTALL_DOCDIR}")

# For builds without CMake. The prefix is where the files are, as they may be moved.
file(RELATIVE_PATH PC_PREFIX "/prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/prefix")
foreach(name shadowcache shadowcache-render)
    configure_file("common/cmake/${name}.pc.in" "${PROJECT_BINARY_DIR}/${name}.pc" @ONLY)
    install(FILES "${PROJECT_BINARY_DIR}/${name}.pc" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig")
endforeach()

install(EXPORT shadowcache_targets NAMESPACE shadowcache:: FILE shadowcacheTargets.cmake
    DESTINATION "${SHADOWCACHE_CONFIG_DIR}")
install(EXPORT shadowcache_render_targets NAMESPACE shadowcache:: FILE shadowcacheRenderTargets.cmake
    DESTINATION "${SHADOWCACHE_CONFIG_DIR}")
configure_package_config_file(common/cmake/shadowcacheConfig.cmake.in
    "${PROJECT_BINARY_DIR}/shadowcacheConfig.cmake" INSTALL_DESTINATION "${SHADOWCACHE_CONFIG_DIR}")
write_basic_package_version_file("${PROJECT_BINARY_DIR}/shadowcacheConfigVersion.cmake"
    COMPATIBILITY SameMinorVersion)
install(FILES
    "${PROJECT_BINARY_DIR}/shadowcacheConfig.cmake"
    "${PROJECT_BINARY_DIR}/shadowcacheConfigVersion.cmake"
    DESTINATION "${SHADOWCACHE_CONFIG_DIR}")
