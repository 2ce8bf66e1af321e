# The check of the rooms (common/cmake/check_rooms.cmake) accepts a tree whose includes follow the list
# and rejects each tree that breaks it in one place:
#   cmake -D CHECK=common/cmake/check_rooms.cmake -D WORK=build -P tests/rooms/check_rooms_test.cmake
cmake_minimum_required(VERSION 3.25)

# make_tree(): two rooms, of which the upper may include the lower.
function(make_tree)
    file(REMOVE_RECURSE "${WORK}")
    file(WRITE "${WORK}/rooms.txt" "common/lower: common/lower\nrender/upper: render/upper common/lower\n")
    file(WRITE "${WORK}/common/lower/stone.h" "#pragma once\n#include <vector>\n")
    file(WRITE "${WORK}/common/lower/stone.cpp" "#include \"common/lower/stone.h\"\n")
    file(WRITE "${WORK}/render/upper/roof.h" "#pragma once\n#include \"common/lower/stone.h\"\n")
    file(WRITE "${WORK}/render/upper/roof.cpp" "#include \"render/upper/roof.h\"\n")
endfunction()

# check(NAME [MESSAGE]): the check fails with the message, or passes if there is none.
function(check name)
    execute_process(
        COMMAND "${CMAKE_COMMAND}" -D "ROOMS=${WORK}/rooms.txt" -D "SOURCE=${WORK}" -P "${CHECK}"
        RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
    string(REGEX REPLACE "[ \n]+" " " output "${output}")
    if(ARGC EQUAL 1 AND NOT status EQUAL 0)
        message(SEND_ERROR "${name}: rejected: ${output}")
    elseif(ARGC EQUAL 2 AND status EQUAL 0)
        message(SEND_ERROR "${name}: accepted")
    elseif(ARGC EQUAL 2)
        string(FIND "${output}" "${ARGV1}" found)
        if(found EQUAL -1)
            message(SEND_ERROR "${name}: expected '${ARGV1}' in: ${output}")
        endif()
    endif()
endfunction()

make_tree()
check("downward includes")

make_tree()
file(APPEND "${WORK}/common/lower/stone.cpp" "#include \"render/upper/roof.h\"\n")
check("upward include in a source"
    "common/lower/stone.cpp includes render/upper/roof.h; common/lower may include: common/lower")

make_tree()
file(APPEND "${WORK}/common/lower/stone.h" "#include \"render/upper/roof.h\"  // why\n")
check("upward include in a header" "common/lower/stone.h includes render/upper/roof.h")

make_tree()
file(WRITE "${WORK}/common/cellar/coal.h" "#pragma once\n")
check("folder without a room" "common/cellar/coal.h: its folder is no room")

make_tree()
file(APPEND "${WORK}/render/upper/roof.cpp" "#include \"stone.h\"\n")
check("include that is not from the root" "render/upper/roof.cpp includes stone.h")

make_tree()
file(WRITE "${WORK}/rooms.txt" "common/lower: common/lower\nrender/upper: render/upper\n")
check("list without the room" "render/upper/roof.h includes common/lower/stone.h")
