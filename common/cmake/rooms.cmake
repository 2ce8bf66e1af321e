# The rooms of the house: each folder of common/, bake/ and render/ is one library with one purpose, and
# says which rooms it may include. What these may include, it may include, too.

# The set of headers that rooms share which are not cold. A folder may have one of its own.
set(SHADOWCACHE_ROOM_HEADERS shadowcache_room_headers)

# shadowcache_room(NAME [COLD] SOURCES file... [MAY_INCLUDE room...] [PACKAGES target...])
# The room in the folder NAME beside the caller becomes the library shadowcache_TOP_NAME. Rooms are named
# TOP/NAME; PACKAGES are those of Debian that only this room sees. COLD: nothing in it
# takes time when a program runs.
function(shadowcache_room name)
    cmake_parse_arguments(room "COLD" "" "SOURCES;MAY_INCLUDE;PACKAGES" ${ARGN})
    cmake_path(RELATIVE_PATH CMAKE_CURRENT_SOURCE_DIR BASE_DIRECTORY "${PROJECT_SOURCE_DIR}"
        OUTPUT_VARIABLE top)
    set(target shadowcache_${top}_${name})
    list(TRANSFORM room_SOURCES PREPEND ${name}/)
    if(room_SOURCES)
        add_library(${target} STATIC ${room_SOURCES})
        set(scope PUBLIC)
        target_link_libraries(${target} PRIVATE ${room_PACKAGES})
        shadowcache_compile_together(${target})
        if(room_COLD)
            shadowcache_compile_cold(${target})
        else()
            shadowcache_share_headers(${target} ${SHADOWCACHE_ROOM_HEADERS})
        endif()
    else()
        add_library(${target} INTERFACE)
        set(scope INTERFACE)
    endif()
    add_dependencies(${target} shadowcache_rooms)
    target_include_directories(${target} ${scope}
        "${PROJECT_SOURCE_DIR}" "${PROJECT_BINARY_DIR}/generated")
    target_link_libraries(${target} ${scope} shadowcache_options)
    foreach(other IN LISTS room_MAY_INCLUDE)
        string(REPLACE / _ library ${other})
        target_link_libraries(${target} ${scope} shadowcache_${library})
    endforeach()
    shadowcache_may_include(${top}/${name} ${room_MAY_INCLUDE})
endfunction()

# shadowcache_compile_cold(TARGET): as a cold room is.
function(shadowcache_compile_cold target)
    shadowcache_compile_quickly(${target})
    shadowcache_share_headers(${target} shadowcache_cold_headers)
endfunction()

# shadowcache_may_include(FOLDER room...): files in FOLDER may include these rooms, and theirs.
function(shadowcache_may_include folder)
    set(allowed ${folder})
    foreach(other IN LISTS ARGN)
        get_property(theirs GLOBAL PROPERTY shadowcache_allowed_${other})
        if(NOT theirs)
            message(FATAL_ERROR "${folder} may include ${other}: a room that comes after it, or none")
        endif()
        list(APPEND allowed ${theirs})
    endforeach()
    list(REMOVE_DUPLICATES allowed)
    set_property(GLOBAL PROPERTY shadowcache_allowed_${folder} "${allowed}")
    list(JOIN allowed " " allowed)
    set_property(GLOBAL APPEND_STRING PROPERTY shadowcache_rooms "${folder}: ${allowed}\n")
endfunction()

# The check of all #include lines against the rooms' lists; every library waits for it. Called when
# all rooms are known.
function(shadowcache_check_rooms)
    get_property(rooms GLOBAL PROPERTY shadowcache_rooms)
    file(WRITE "${PROJECT_BINARY_DIR}/rooms.txt" "${rooms}")
endfunction()

add_custom_target(shadowcache_rooms
    COMMAND "${CMAKE_COMMAND}" -D "ROOMS=${PROJECT_BINARY_DIR}/rooms.txt"
        -D "SOURCE=${PROJECT_SOURCE_DIR}" -P "${CMAKE_CURRENT_LIST_DIR}/check_rooms.cmake"
    VERBATIM)

# shadowcache_headers_within(RESULT header...): these headers of ours and all that they include, as paths.
function(shadowcache_headers_within result)
    set(found)
    set(left ${ARGN})
    while(left)
        list(POP_FRONT left header)
        set(file "${PROJECT_SOURCE_DIR}/${header}")
        if(file IN_LIST found OR NOT EXISTS "${file}")
            continue()
        endif()
        list(APPEND found "${file}")
        file(STRINGS "${file}" includes REGEX "^#include \"")
        list(TRANSFORM includes REPLACE "^#include \"([^\"]+)\".*" "\\1")
        list(APPEND left ${includes})
    endwhile()
    set(${result} ${found} PARENT_SCOPE)
endfunction()
