# One static library a folder of src. Its headers are reached as "corda/<folder>/<name>.hpp" through a link in the
# build tree that belongs to that library alone, so a folder can include only what it links: the link line is the
# rule about who may see whom.

add_library(corda_options INTERFACE)
add_library(corda::options ALIAS corda_options)
target_compile_options(corda_options INTERFACE
    -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Wnon-virtual-dtor -Wold-style-cast
    # GCC 12 sees overlapping copies in ordinary joining of strings (PR 105651).
    $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>
    # The same scene must give the same bytes on every x86-64 CPU and compiler: no fused multiply-add.
    -ffp-contract=off)
if(CORDA_WARNINGS_AS_ERRORS)
    target_compile_options(corda_options INTERFACE -Werror)
endif()
if(CORDA_SANITIZE)
    target_compile_options(corda_options INTERFACE -fsanitize=address,undefined -fno-sanitize-recover=all
        -fno-omit-frame-pointer
        # GCC 12 sees uninitialised values in std::regex where it is instrumented (PR 105562).
        $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
    target_link_options(corda_options INTERFACE -fsanitize=address,undefined)
endif()

# corda_link_sanitizer(<executable>): what an executable needs for readable reports, under CORDA_SANITIZE alone.
function(corda_link_sanitizer target)
    if(CORDA_SANITIZE)
        target_sources(${target} PRIVATE ${PROJECT_SOURCE_DIR}/tests/support/keep_modules.cpp)
    endif()
endfunction()

# corda_add_library(<folder> SOURCES <files> [PUBLIC <targets>] [PRIVATE <targets>])
function(corda_add_library folder)
    cmake_parse_arguments(ARG "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
    add_library(corda_${folder} STATIC ${ARG_SOURCES})
    add_library(corda::${folder} ALIAS corda_${folder})
    set_target_properties(corda_${folder} PROPERTIES EXPORT_NAME ${folder} POSITION_INDEPENDENT_CODE ON)
    set(include_dir ${PROJECT_BINARY_DIR}/include/${folder})
    file(MAKE_DIRECTORY ${include_dir}/corda)
    file(CREATE_LINK ${CMAKE_CURRENT_SOURCE_DIR} ${include_dir}/corda/${folder} SYMBOLIC)
    target_include_directories(corda_${folder} PUBLIC $<BUILD_INTERFACE:${include_dir}>
        $<INSTALL_INTERFACE:include>)
    target_compile_features(corda_${folder} PUBLIC cxx_std_20)
    target_link_libraries(corda_${folder} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE} $<BUILD_INTERFACE:corda::options>)
    set_property(GLOBAL APPEND PROPERTY CORDA_LIBRARIES corda_${folder})
endfunction()
