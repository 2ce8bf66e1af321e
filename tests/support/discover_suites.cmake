# Writes FILE, which adds one test for each suite of the GoogleTest program PROGRAM that the filter FILTER leaves.
execute_process(COMMAND "${PROGRAM}" --gtest_list_tests "--gtest_filter=${FILTER}"
    OUTPUT_VARIABLE listing COMMAND_ERROR_IS_FATAL ANY)
set(tests)
string(REGEX MATCHALL "(^|\n)[^ \n]+[.](  #[^\n]*)?\n" suites "${listing}")
foreach(suite IN LISTS suites)
    string(REGEX REPLACE "^\n?([^ \n]+)[.].*" "\\1" name "${suite}")
    string(APPEND tests
        "add_test([==[${name}]==] [==[${PROGRAM}]==] [==[--gtest_filter=${name}.${FILTER}]==])\n"
        "set_tests_properties([==[${name}]==] PROPERTIES LABELS [==[${LABEL}]==])\n")
endforeach()
file(WRITE "${FILE}" "${tests}")
