# corda_add_golden_tests(DIR <scenes> GOLDEN <references> [NAME <name>] [LABELS <labels>] [OPTIONS <arguments of corda golden>]):
# adds a test that compares the scenes of a folder that have a table [golden] with their kept pictures, and a target
# update_<name> that rewrites the pictures. Both folders are relative to the source folder. Failures are shown in
# <name>.html and <name>.xml (JUnit) in the binary folder. NAME defaults to the name of the folder of references.
function(corda_add_golden_tests)
    cmake_parse_arguments(PARSE_ARGV 0 ARG "" "DIR;GOLDEN;NAME" "LABELS;OPTIONS")
    if(NOT ARG_DIR OR NOT ARG_GOLDEN OR ARG_UNPARSED_ARGUMENTS)
        message(FATAL_ERROR "corda_add_golden_tests(DIR <scenes> GOLDEN <references> ...) got: ${ARGN}")
    endif()
    string(REGEX REPLACE "(.)/+$" "\\1" ARG_GOLDEN ${ARG_GOLDEN})
    cmake_path(ABSOLUTE_PATH ARG_DIR)
    cmake_path(ABSOLUTE_PATH ARG_GOLDEN)
    if(NOT ARG_NAME)
        cmake_path(GET ARG_GOLDEN FILENAME ARG_NAME)
    endif()
    if(TARGET corda)
        set(program $<TARGET_FILE:corda>)
    else()
        find_program(CORDA_PROGRAM corda HINTS ${CORDA_PROGRAM_FOLDER} DOC "the program corda, for golden tests" REQUIRED)
        set(program ${CORDA_PROGRAM})
    endif()
    set(command ${program} golden ${ARG_DIR} --dir ${ARG_GOLDEN} ${ARG_OPTIONS})
    add_test(NAME ${ARG_NAME} COMMAND ${command} --html ${CMAKE_CURRENT_BINARY_DIR}/${ARG_NAME}.html
        --junit ${CMAKE_CURRENT_BINARY_DIR}/${ARG_NAME}.xml)
    set_tests_properties(${ARG_NAME} PROPERTIES LABELS "${ARG_LABELS}")
    add_custom_target(update_${ARG_NAME} COMMAND ${command} --update USES_TERMINAL VERBATIM)
endfunction()
