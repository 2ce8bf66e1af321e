# Included by the presets: the compiler runs through ccache where that is installed. Precompiled headers
# need the sloppiness: what they were made of is in their bytes. They need depend mode, too: without it, a
# header in which only comments changed gives the old precompiled header back, which knows the old file by
# its hash, so that `#pragma once` lets the new one in a second time. The namespace keeps apart what a cache
# holds from compilations without depend mode, which depend mode would take for its own. Paths are relative to
# the sources, so that all checkouts share what was compiled.
find_program(SHADOWCACHE_CCACHE ccache)
mark_as_advanced(SHADOWCACHE_CCACHE)
if(SHADOWCACHE_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
    set(CMAKE_CXX_COMPILER_LAUNCHER "${CMAKE_COMMAND}" -E env CCACHE_DEPEND=true
        CCACHE_NAMESPACE=shadowcache-depend "CCACHE_BASEDIR=${CMAKE_SOURCE_DIR}" CCACHE_NOHASHDIR=true
        CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime
        "${SHADOWCACHE_CCACHE}")
endif()
