# shadowcache_help_files(PROGRAM): the program's man page and its completion for bash, made by the
# program itself and installed with it.
function(shadowcache_help_files program)
    if(SHADOWCACHE_SANITIZE)
        return()  # not what is installed
    endif()
    set(page "${PROJECT_BINARY_DIR}/help/${program}.1")
    set(completion "${PROJECT_BINARY_DIR}/help/${program}")
    file(MAKE_DIRECTORY "${PROJECT_BINARY_DIR}/help")
    add_custom_command(OUTPUT "${page}" "${completion}"
        COMMAND ${program} --man-page > "${page}"
        COMMAND ${program} --bash-completion > "${completion}"
        DEPENDS ${program} VERBATIM)
    add_custom_target(${program}-help ALL DEPENDS "${page}" "${completion}")
    # A build of some targets, as scenes/demo makes it, is no package.
    install(CODE "if(NOT EXISTS \"${page}\" OR NOT EXISTS \"${completion}\")
    message(FATAL_ERROR \"The man page of ${program} is not there: cmake --install needs all of the build, which cmake --build ${PROJECT_BINARY_DIR} makes\")
endif()")
    install(FILES "${page}" DESTINATION "${CMAKE_INSTALL_MANDIR}/man1")
    install(FILES "${completion}"
        DESTINATION "${CMAKE_INSTALL_DATADIR}/bash-completion/completions")
endfunction()
