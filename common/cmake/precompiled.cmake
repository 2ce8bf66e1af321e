# Headers that many files include are parsed once, for a set of targets with equal flags. Every file still
# includes what it needs: tests/check clang and tests/check tidy compile it without these sets. Headers with
# long inline functions, as those of CLI11, have no place in a set: each file would compile these.

# Clang refuses a set that ccache brings back: it holds the dates of its headers.
if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    set(CMAKE_DISABLE_PRECOMPILE_HEADERS ON)
endif()

set(SHADOWCACHE_COMMON_HEADERS
    <algorithm>
    <array>
    <bit>
    <cassert>
    <chrono>
    <cmath>
    <cstddef>
    <cstdint>
    <cstdio>
    <cstdlib>
    <cstring>
    <filesystem>
    <fstream>
    <functional>
    <limits>
    <map>
    <memory>
    <mutex>
    <numeric>
    <optional>
    <span>
    <sstream>
    <string>
    <string_view>
    <utility>
    <vector>
    <common/math/vec.h>)

# shadowcache_headers(NAME HEADERS header... [PACKAGES target...])
# A set of headers that files can share: those above, and HEADERS, which need PACKAGES. Its flags are those
# of the place where it is called. GCC optimises what uses a set as it did the set, whatever level the file's own
# flags name: each level needs a set of its own (shadowcache_compile_quickly).
function(shadowcache_headers name)
    cmake_parse_arguments(set "" "" "HEADERS;PACKAGES" ${ARGN})
    # The set is a target, and a target has a source.
    set(source "${PROJECT_BINARY_DIR}/generated/${name}.cpp")
    file(CONFIGURE OUTPUT "${source}" CONTENT "")
    add_library(${name} OBJECT EXCLUDE_FROM_ALL "${source}")
    target_include_directories(${name} PRIVATE "${PROJECT_SOURCE_DIR}" "${PROJECT_BINARY_DIR}/generated")
    target_link_libraries(${name} PRIVATE shadowcache_options Imath::Imath ${set_PACKAGES})
    target_precompile_headers(${name} PRIVATE ${SHADOWCACHE_COMMON_HEADERS} ${set_HEADERS})
    # For ccache, which hashes what GCC has preprocessed.
    target_compile_options(${name} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>)
endfunction()

# shadowcache_share_headers(TARGET SET): the files of TARGET find those headers parsed.
function(shadowcache_share_headers target set)
    target_precompile_headers(${target} REUSE_FROM ${set})
    target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>)
endfunction()
