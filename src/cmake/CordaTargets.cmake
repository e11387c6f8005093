# One library per room, a folder of src/corda. Headers are included as "corda/<room>/<name>.hpp" from the one include root,
# src. The table in src/README.md says which room may include which; rooms.awk checks it whenever CMake configures.
set(CORDA_INCLUDE_ROOT ${PROJECT_SOURCE_DIR}/src)
file(GLOB_RECURSE sources ${CORDA_INCLUDE_ROOT}/corda/*.hpp ${CORDA_INCLUDE_ROOT}/corda/*.cpp)
execute_process(COMMAND awk -f ${CMAKE_CURRENT_LIST_DIR}/rooms.awk ${PROJECT_SOURCE_DIR}/src/README.md ${sources}
    RESULT_VARIABLE status OUTPUT_VARIABLE violations)
if(NOT status EQUAL 0)
    message(FATAL_ERROR "an include that src/README.md does not allow:\n${violations}")
endif()

add_library(corda_options INTERFACE)
add_library(corda::options ALIAS corda_options)
target_compile_options(corda_options INTERFACE
    -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Wnon-virtual-dtor -Wold-style-cast
    # GCC 12 reports overlapping copies in ordinary string concatenation (PR 105651), and GCC 12 to 14 an unset member in
    # std::optional (PR 80635).
    $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict;-Wno-maybe-uninitialized>
    # Clang warns of each loop with CORDA_INDEPENDENT that it does not vectorise, as without optimisation.
    $<$<CXX_COMPILER_ID:Clang>:-Wno-pass-failed>
    # No fused multiply-add: the same scene must give the same bytes on every CPU and with every compiler.
    -ffp-contract=off)
if(CORDA_WARNINGS_AS_ERRORS)
    target_compile_options(corda_options INTERFACE -Werror)
endif()
if(CORDA_SANITIZE)
    target_compile_options(corda_options INTERFACE
        -fsanitize=${CORDA_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
    target_link_options(corda_options INTERFACE -fsanitize=${CORDA_SANITIZE})
    # ThreadSanitizer is not ready when the choice between clones is made.
    target_compile_definitions(corda_options INTERFACE CORDA_SANITIZE)
    if(CORDA_SANITIZE STREQUAL "thread")
        target_compile_definitions(corda_options INTERFACE CORDA_NO_CLONES)
    endif()
endif()

# corda_optimise(<folder>): optimises a folder under CORDA_SANITIZE. Others take longer to optimise than to run.
function(corda_optimise folder)
    if(CORDA_SANITIZE)
        target_compile_options(corda_${folder}_objects PRIVATE -O1)
    endif()
endfunction()

# corda_link_sanitizer(<executable>): makes the reports of an executable readable under CORDA_SANITIZE.
function(corda_link_sanitizer target)
    if(NOT CORDA_SANITIZE)
        return()
    endif()
    if(NOT TARGET corda_keep_modules)
        add_library(corda_keep_modules OBJECT ${PROJECT_SOURCE_DIR}/tests/support/keep_modules.cpp)
        target_link_libraries(corda_keep_modules PRIVATE corda::options)
    endif()
    target_sources(${target} PRIVATE $<TARGET_OBJECTS:corda_keep_modules>)
endfunction()

# corda_add_library(<folder> [PUBLIC <targets>] [PRIVATE <targets>] [EXCEPT <file>]): a library of all .cpp files in and
# below the folder.
# Compiled once, as objects that the public library (corda_add_public_library) uses, too.
function(corda_add_library folder)
    cmake_parse_arguments(ARG "" "EXCEPT" "PUBLIC;PRIVATE" ${ARGN})
    file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
    list(REMOVE_ITEM sources "${CMAKE_CURRENT_SOURCE_DIR}/${ARG_EXCEPT}")
    add_library(corda_${folder}_objects OBJECT ${sources})
    add_library(corda_${folder} STATIC EXCLUDE_FROM_ALL $<TARGET_OBJECTS:corda_${folder}_objects>)
    add_library(corda::${folder} ALIAS corda_${folder})
    foreach(target corda_${folder}_objects corda_${folder})
        # A shared library exports the declarations between visibility pragmas in the public headers.
        set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON
            CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
        target_include_directories(${target} PUBLIC ${CORDA_INCLUDE_ROOT})
        target_link_libraries(${target} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE} corda::options)
    endforeach()
endfunction()

# corda_add_public_library(FOLDERS <folders> PRIVATE <targets>): corda::corda, the one library that is installed, from the
# objects of these folders.
function(corda_add_public_library)
    cmake_parse_arguments(ARG "" "" "FOLDERS;PRIVATE" ${ARGN})
    add_library(corda_library)  # static, or shared with BUILD_SHARED_LIBS
    add_library(corda::corda ALIAS corda_library)
    set_target_properties(corda_library PROPERTIES OUTPUT_NAME corda EXPORT_NAME corda
        VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
    target_compile_features(corda_library PUBLIC cxx_std_20)
    target_link_libraries(corda_library PRIVATE ${ARG_PRIVATE})
    foreach(folder IN LISTS ARG_FOLDERS)
        target_sources(corda_library PRIVATE $<TARGET_OBJECTS:corda_${folder}_objects>)
    endforeach()
    target_include_directories(corda_library PUBLIC $<BUILD_INTERFACE:${CORDA_INCLUDE_ROOT}>
        $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
endfunction()
