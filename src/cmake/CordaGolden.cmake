# For the function below: a test of that name with arguments of `corda golden`.
function(_corda_add_golden_test test)
    string(REPLACE "/" "_" file ${test})
    set(file ${CMAKE_CURRENT_BINARY_DIR}/${file})
    add_test(NAME ${test} COMMAND ${program} golden ${ARGN} --dir ${ARG_GOLDEN} ${ARG_OPTIONS} --html ${file}.html
        --junit ${file}.xml --new ${file}.new)
    set_tests_properties(${test} PROPERTIES LABELS "${ARG_LABELS}")
endfunction()

# corda_add_golden_tests(DIR <scenes> GOLDEN <references> [NAME <name>] [SHARDS <count>] [LABELS <labels>]
#                        [OPTIONS <arguments of corda golden>]):
# adds tests that compare the scenes of a folder that have a table [golden] with their kept pictures, and a target
# update_<name> that rewrites the pictures: a test <name>.<scene> per scene, and <name>.stale for pictures that no scene
# asks for; with SHARDS, a test <name>.<i> per shard of the scenes instead. Both folders are relative to
# the source folder. Failures are shown in <test>.html and <test>.xml (JUnit) in the binary folder; the folder <test>.new
# has their pictures for corda golden --accept. NAME defaults to the name of the folder of references.
function(corda_add_golden_tests)
    cmake_parse_arguments(PARSE_ARGV 0 ARG "" "DIR;GOLDEN;NAME;SHARDS" "LABELS;OPTIONS")
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
    if(ARG_SHARDS)
        math(EXPR last "${ARG_SHARDS} - 1")
        foreach(shard RANGE ${last})
            _corda_add_golden_test(${ARG_NAME}.${shard} ${ARG_DIR} --shard ${shard}/${ARG_SHARDS})
        endforeach()
    else()
        file(GLOB_RECURSE scenes CONFIGURE_DEPENDS ${ARG_DIR}/*.toml)
        foreach(scene IN LISTS scenes)
            # A scene may get its table later.
            set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${scene})
            file(STRINGS ${scene} table REGEX "^[ \t]*(\\[[ \t]*golden[ \t]*\\]|golden[ \t]*[.=])")
            if(table)
                cmake_path(RELATIVE_PATH scene BASE_DIRECTORY ${ARG_DIR} OUTPUT_VARIABLE name)
                cmake_path(REMOVE_EXTENSION name LAST_ONLY)
                _corda_add_golden_test(${ARG_NAME}.${name} ${scene})
            endif()
        endforeach()
        _corda_add_golden_test(${ARG_NAME}.stale ${ARG_DIR} --stale)
    endif()
    add_custom_target(update_${ARG_NAME} COMMAND ${program} golden ${ARG_DIR} --dir ${ARG_GOLDEN} ${ARG_OPTIONS} --update
        USES_TERMINAL VERBATIM)
endfunction()
