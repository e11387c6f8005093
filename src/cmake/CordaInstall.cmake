# Install rules, and the files for find_package(corda) and pkg-config.
include(CMakePackageConfigHelpers)

# The public headers; users of the installed library see only these.
foreach(header
        corda.hpp
        core/basics.hpp core/image.hpp core/rational.hpp
        golden/compare.hpp golden/check_golden.hpp testing.hpp
        media/defs.hpp
        film/film.hpp
        scene/scene.hpp
        sim/defs.hpp sim/simulation.hpp sim/system.hpp
        view/defs.hpp)
    cmake_path(GET header PARENT_PATH folder)
    install(FILES ${PROJECT_SOURCE_DIR}/src/corda/${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/corda/${folder}
        COMPONENT development)
endforeach()

install(TARGETS corda_library EXPORT corda_targets
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development
    LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
install(TARGETS corda RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
# The README and its pages for users, at the same relative places.
file(GLOB pictures RELATIVE ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/tests/benchmark/*.png)
foreach(page LICENSE README.md src/CHANGELOG.md src/cmake/LICENSES.md tests/benchmark/README.md ${pictures}
        src/corda/app/README.md src/corda/golden/README.md src/corda/media/README.md src/corda/python/README.md src/corda/scene/README.md
        src/corda/serve/README.md)
    cmake_path(GET page PARENT_PATH folder)
    install(FILES ${PROJECT_SOURCE_DIR}/${page} DESTINATION ${CMAKE_INSTALL_DOCDIR}/${folder} COMPONENT program)
endforeach()

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/corda)
install(EXPORT corda_targets NAMESPACE corda:: DESTINATION ${package_dir} COMPONENT development)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/corda-config.cmake.in
    ${PROJECT_BINARY_DIR}/corda-config.cmake INSTALL_DESTINATION ${package_dir}
    PATH_VARS CMAKE_INSTALL_BINDIR)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/corda-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_SOURCE_DIR}/src/cmake/CordaGolden.cmake ${PROJECT_BINARY_DIR}/corda-config.cmake ${PROJECT_BINARY_DIR}/corda-config-version.cmake
    DESTINATION ${package_dir} COMPONENT development)
# Users of a static libcorda link its dependencies; a shared libcorda is linked with them.
if(BUILD_SHARED_LIBS)
    set(CORDA_PC_REQUIRES Requires.private)
else()
    set(CORDA_PC_REQUIRES Requires)
endif()
# Relative to the folder of corda.pc, so that the installed tree can be moved.
set(pc_dir ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig)
cmake_path(RELATIVE_PATH CMAKE_INSTALL_PREFIX BASE_DIRECTORY ${pc_dir} OUTPUT_VARIABLE CORDA_PC_TO_PREFIX)
configure_file(${CMAKE_CURRENT_LIST_DIR}/corda.pc.in ${PROJECT_BINARY_DIR}/corda.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/corda.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)
