# Prints one value of a JSON file, so that scripts need no other tool:
#   cmake -D FILE=stats.json -D KEY=seconds.render -P common/cmake/json_value.cmake
file(READ "${FILE}" json)
string(REPLACE "." ";" path "${KEY}")
string(JSON value GET "${json}" ${path})
execute_process(COMMAND "${CMAKE_COMMAND}" -E echo "${value}")
