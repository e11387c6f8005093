# Install rules and the package that find_package(corda) reads.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

get_property(libraries GLOBAL PROPERTY CORDA_LIBRARIES)
install(TARGETS ${libraries} EXPORT corda_targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
foreach(module core sim study view gl render media golden scene)
    install(DIRECTORY ${PROJECT_SOURCE_DIR}/src/${module}/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/corda/${module}
        FILES_MATCHING PATTERN "*.hpp")
endforeach()
install(TARGETS corda RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/corda)
install(EXPORT corda_targets NAMESPACE corda:: DESTINATION ${package_dir})
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/corda-config.cmake.in
    ${PROJECT_BINARY_DIR}/corda-config.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/corda-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/corda-config.cmake ${PROJECT_BINARY_DIR}/corda-config-version.cmake
    DESTINATION ${package_dir})
