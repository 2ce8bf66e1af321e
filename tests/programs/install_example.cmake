# Installs the build tree into a prefix of its own, moves that, builds the docs/examples against it, and
# asks a cache that the installed program baked. Needs BUILD, SOURCE, WORK, GENERATOR and COMPILER.
function(run)
    execute_process(COMMAND ${ARGN} WORKING_DIRECTORY "${WORK}" RESULT_VARIABLE status
        OUTPUT_VARIABLE output ERROR_VARIABLE output)
    if(NOT status EQUAL 0)
        message(FATAL_ERROR "${ARGN}: status ${status}\n${output}")
    endif()
    set(output "${output}" PARENT_SCOPE)
endfunction()

function(expect wanted)
    if(NOT output MATCHES "${wanted}")
        message(FATAL_ERROR "'${wanted}' is not in:\n${output}")
    endif()
endfunction()

file(REMOVE_RECURSE "${WORK}")
file(MAKE_DIRECTORY "${WORK}")
run("${CMAKE_COMMAND}" --install "${BUILD}" --prefix "${WORK}/installed")
file(RENAME "${WORK}/installed" "${WORK}/prefix")
foreach(program bake render info merge)
    file(GLOB page "${WORK}/prefix/share/man/man1/shadowcache-${program}.1")
    file(GLOB completion
        "${WORK}/prefix/share/bash-completion/completions/shadowcache-${program}")
    if(NOT page OR NOT completion)
        message(FATAL_ERROR "shadowcache-${program} has no man page or no completion")
    endif()
endforeach()
# Of a build of some targets, as scenes/demo makes it, nothing is installed; the message names the build that is needed.
file(READ "${BUILD}/bake/cmake_install.cmake" script)
string(REPLACE "${BUILD}/help/" "${WORK}/no_help/" script "${script}")
file(WRITE "${WORK}/install_part.cmake" "${script}")
execute_process(COMMAND "${CMAKE_COMMAND}" -D "CMAKE_INSTALL_PREFIX=${WORK}/part" -P "${WORK}/install_part.cmake"
    RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
string(REGEX REPLACE "[ \n]+" " " output "${output}")
expect("man page of shadowcache-[a-z]+ is not there: .*which cmake --build ${BUILD} makes")
if(status EQUAL 0 OR EXISTS "${WORK}/part")
    message(FATAL_ERROR "a part of the build is installed")
endif()
# build(EXAMPLE ARGUMENT...): one of docs/examples, in build/EXAMPLE.
function(build example)
    run("${CMAKE_COMMAND}" -S "${SOURCE}/docs/examples/${example}" -B "${WORK}/build/${example}"
        -G "${GENERATOR}" -D "CMAKE_CXX_COMPILER=${COMPILER}" -D CMAKE_BUILD_TYPE=Release
        -D "CMAKE_PREFIX_PATH=${WORK}/prefix" ${ARGN})
    run("${CMAKE_COMMAND}" --build "${WORK}/build/${example}")
endfunction()
# What the library does not use is not demanded of whoever links it.
build(read_cache
    -D CMAKE_DISABLE_FIND_PACKAGE_embree=ON -D CMAKE_DISABLE_FIND_PACKAGE_OpenMesh=ON
    -D CMAKE_DISABLE_FIND_PACKAGE_nlohmann_json=ON -D CMAKE_DISABLE_FIND_PACKAGE_CLI11=ON)
build(render_set -D CMAKE_DISABLE_FIND_PACKAGE_CLI11=ON)
build(path_tracer -D CMAKE_DISABLE_FIND_PACKAGE_OpenMesh=ON)
# The examples are installed, and are built without CMake as well.
set(examples "${WORK}/prefix/share/doc/shadowcache/examples")
file(GLOB packages "${WORK}/prefix/lib/pkgconfig" "${WORK}/prefix/lib/*/pkgconfig")
foreach(example shadowcache/read_cache shadowcache-render/render_set)
    cmake_path(GET example FILENAME name)
    cmake_path(GET example PARENT_PATH package)
    run("${CMAKE_COMMAND}" -E env "PKG_CONFIG_PATH=${packages}" sh -c
        "${COMPILER} -std=c++20 ${examples}/${name}/${name}.cpp -o ${name} $(pkg-config --cflags --libs ${package})")
    if(NOT EXISTS "${WORK}/${name}")
        message(FATAL_ERROR "${name} is not built by pkg-config")
    endif()
endforeach()
if(NOT EXISTS "${examples}/python/year_of_sensors.py")
    message(FATAL_ERROR "the scripts are not installed")
endif()
# Nothing but what it says itself is printed.
run("${WORK}/build/render_set/render_set")
set(wanted "^bake: done\n[1-9][0-9]* items\nsky 1.0: mean 0[.]([0-9]+)\nsky 0.5: mean 0[.]([0-9]+)\n$")
expect("${wanted}")
string(REGEX MATCH "${wanted}" matched "${output}")
math(EXPR difference "1${CMAKE_MATCH_1} + 10000 - 2 * 1${CMAKE_MATCH_2}")
if(difference LESS -10 OR difference GREATER 10)
    message(FATAL_ERROR "half of the light does not make half of the picture:\n${output}")
endif()

# Another version is refused.
file(WRITE "${WORK}/version/CMakeLists.txt" "cmake_minimum_required(VERSION 3.25)
project(version LANGUAGES NONE)
find_package(shadowcache 0.0 CONFIG QUIET)
if(NOT shadowcache_CONSIDERED_CONFIGS OR shadowcache_FOUND)
    message(FATAL_ERROR \"considered: \${shadowcache_CONSIDERED_CONFIGS}\")
endif()")
run("${CMAKE_COMMAND}" -S "${WORK}/version" -B "${WORK}/build/version"
    -D "CMAKE_PREFIX_PATH=${WORK}/prefix")

# A floor, and a roof over its half x < 0.
file(WRITE "${WORK}/set.obj"
    "v -2 0 -2\nv 2 0 -2\nv 2 0 2\nv -2 0 2\nv -2 0.2 -2\nv 0 0.2 -2\nv 0 0.2 2\nv -2 0.2 2\n"
    "f 1 2 3 4\nf 5 6 7 8\n")
run("${WORK}/prefix/bin/shadowcache-bake" set.obj -o set.vdb --spacing 0.1)
# A map of the radiance 1/8 everywhere: under an open sky the irradiance is pi / 8 = 0.393, a little less beside the roof.
string(ASCII 64 64 64 127 texel)
file(WRITE "${WORK}/sky.hdr" "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n${texel}")
run("${WORK}/read_cache" set.vdb 1.5 0 0.1 0 1 0 sky.hdr)
expect("sky visibility (9[0-9]|100) %")
run("${WORK}/build/read_cache/read_cache" set.vdb 1.5 0 0.1 0 1 0 sky.hdr)
expect("sky visibility (9[0-9]|100) %")
expect("irradiance (0[.]3[89][0-9]) (0[.]3[89][0-9]) (0[.]3[89][0-9])")
run("${WORK}/build/read_cache/read_cache" set.vdb -1 0 0.1 0 1 0 sky.hdr)
expect("[1-9][0-9]* items here, sky visibility [0-9] %")
expect("irradiance 0[.]0[0-3]")
run("${WORK}/build/read_cache/read_cache" set.vdb 1.5 5 0.1 0 1 0 sky.hdr)
expect("0 items here.*the cache has nothing here")
run("${WORK}/build/path_tracer/path_tracer" set.obj set.vdb sky.hdr a.pfm size=8,8 spp=1)
run("${WORK}/prefix/bin/shadowcache-info" set.vdb)
expect("items +[1-9]")
run("${WORK}/prefix/bin/shadowcache-merge" set.vdb -o merged.vdb)
run("${WORK}/prefix/bin/shadowcache-render" set.obj --env 1,1,1 --cache merged.vdb --eye 1,1,1
    --look-at 0,0,0 --size 8x8 -o a.exr)
file(REMOVE_RECURSE "${WORK}")
