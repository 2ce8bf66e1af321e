# shadowcache_compile_quickly(TARGET [LEVEL]): in release builds with little optimisation, -O1, which takes six
# tenths of the time that -O3 takes, or with another level. For what is not hot. If it shares precompiled headers,
# they are compiled with the same level (common/cmake/precompiled.cmake).
function(shadowcache_compile_quickly target)
    set(level ${ARGN} -O1)
    list(GET level 0 level)
    target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:${level}>)
endfunction()

# shadowcache_compile_together(TARGET): its files in batches, each compiled as one: what they include is
# parsed, and the templates that they use are compiled, once a batch. Names in anonymous namespaces must
# differ within a batch.
function(shadowcache_compile_together target)
    set_target_properties(${target} PROPERTIES
        UNITY_BUILD ${SHADOWCACHE_UNITY} UNITY_BUILD_BATCH_SIZE 12)
    # A type of an anonymous namespace stays in its .cpp file, whichever includes that.
    target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
endfunction()

# Flags that every target of ours shares.
add_library(shadowcache_options INTERFACE)
target_compile_features(shadowcache_options INTERFACE cxx_std_20)
target_compile_definitions(shadowcache_options INTERFACE
    $<$<BOOL:${SHADOWCACHE_TUNABLE}>:SHADOWCACHE_TUNABLE>)
target_compile_options(shadowcache_options INTERFACE
    -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wdouble-promotion -Wnon-virtual-dtor
    # As g++ has -Wconversion in C++.
    $<$<CXX_COMPILER_ID:Clang>:-Wno-sign-conversion>
    # Nobody reads errno or the trap flags of floating point: loops with roots and choices become
    # SIMD code. Results stay those of IEEE 754.
    -fno-math-errno -fno-trapping-math
    # GCC 12 sees overlaps in std::string that cannot be (bug 105651).
    $<$<AND:$<CXX_COMPILER_ID:GNU>,$<VERSION_LESS:$<CXX_COMPILER_VERSION>,13>>:-Wno-restrict>
    $<$<BOOL:${SHADOWCACHE_WERROR}>:-Werror>
    $<$<BOOL:${SHADOWCACHE_ARCH}>:-march=${SHADOWCACHE_ARCH}>)
# What is linked is found once, before main(), and read-only from then on (docs/security.md). Debian's
# compilers make position-independent programs.
target_link_options(shadowcache_options INTERFACE -Wl,-z,relro,-z,now)
# What release builds of the rooms and programs add; docs/security.md has what each costs. Tests do
# without, and so do the other configurations, whose sanitizers see more.
set(SHADOWCACHE_HARDENING)
if(SHADOWCACHE_HARDEN AND CMAKE_BUILD_TYPE STREQUAL "Release" AND NOT SHADOWCACHE_SANITIZE)
    set(SHADOWCACHE_HARDENING "-fstack-protector-strong -fstack-clash-protection -fcf-protection \
-U_FORTIFY_SOURCE -D_FORTIFY_SOURCE=3")
endif()
if(SHADOWCACHE_FUZZ)
    # A fault found by any sanitizer ends the run.
    target_compile_options(shadowcache_options INTERFACE
        -fsanitize=fuzzer-no-link -fno-sanitize-recover=all)
endif()
if(SHADOWCACHE_SANITIZE)
    # GCC's analysis is at a loss in instrumented code: <regex> (bug 105562), std::string (105329).
    target_compile_options(shadowcache_options INTERFACE
        -fsanitize=${SHADOWCACHE_SANITIZE} -fno-omit-frame-pointer
        "$<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized;-Wno-stringop-overflow;-Wno-array-bounds>")
    # Slow to compile, and mostly checked elsewhere: the address sanitizer sees null pointers and what is
    # outside of an object; the fuzzers' clang sees misaligned addresses and wrong types where they go.
    target_compile_options(shadowcache_options INTERFACE
        $<$<CXX_COMPILER_ID:GNU>:-fno-sanitize=null,alignment,object-size,vptr>)
    target_link_options(shadowcache_options INTERFACE -fsanitize=${SHADOWCACHE_SANITIZE})
endif()
