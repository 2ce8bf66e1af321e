# Included by the presets: the compiler runs through ccache where that is installed.
find_program(SHADOWCACHE_CCACHE ccache)
mark_as_advanced(SHADOWCACHE_CCACHE)
if(SHADOWCACHE_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
    set(CMAKE_CXX_COMPILER_LAUNCHER "${SHADOWCACHE_CCACHE}")
endif()
