# Generated documentation of the program, and Debian packages: `cpack --config build/release/CPackConfig.cmake`.

# corda_install_output(<name> <destination> <arguments of corda>): installs the output of the program.
function(corda_install_output name destination)
    set(file ${PROJECT_BINARY_DIR}/generated/share/${name})
    list(JOIN ARGN " " arguments)
    add_custom_command(OUTPUT ${file} COMMAND sh -c "'$<TARGET_FILE:corda>' ${arguments} >'${file}'" DEPENDS corda VERBATIM)
    set_property(GLOBAL APPEND PROPERTY corda_outputs ${file})
    install(FILES ${file} DESTINATION ${CMAKE_INSTALL_DATADIR}/${destination} COMPONENT program)
endfunction()

file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/generated/share)
corda_install_output(corda.1 man/man1 help man)
corda_install_output(corda bash-completion/completions completion bash)
corda_install_output(_corda zsh/vendor-completions completion zsh)
corda_install_output(corda.fish fish/vendor_completions.d completion fish)
corda_install_output(corda.schema.json corda schema)
get_property(outputs GLOBAL PROPERTY corda_outputs)
add_custom_target(corda_outputs ALL DEPENDS ${outputs})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/examples DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program
    FILES_MATCHING PATTERN "*.toml" PATTERN "pictures" EXCLUDE)
install(FILES ${CMAKE_CURRENT_LIST_DIR}/copyright DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)
install(FILES ${CMAKE_CURRENT_LIST_DIR}/copyright DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/libcorda-dev COMPONENT development)
install(FILES ${CMAKE_CURRENT_LIST_DIR}/copyright DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/python3-corda COMPONENT python)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "The Corda authors <corda@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL program development python)
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)

set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME corda)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
# Loaded at run time, so that dpkg-shlibdeps does not see them: OpenGL on the CPU.
set(loaded "libegl1, libegl-mesa0, libopengl0, libgl1-mesa-dri")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS "${loaded}")
set(CPACK_DEBIAN_PROGRAM_DESCRIPTION "The program: it simulates ropes and nets of particles and bars, draws each frame \
with OpenGL on a machine without a screen, the same bytes on every run, and encodes video.")

set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libcorda-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
# The dependencies of a program that links the static library.
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "${loaded}, libavcodec-dev, libavformat-dev, libavutil-dev, libx264-dev, libcairo2-dev, libegl-dev, \
libeigen3-dev, libepoxy-dev, libfmt-dev, libfreetype-dev, libpng-dev, \
libtomlplusplus-dev, nlohmann-json3-dev, pkg-config, zlib1g-dev")
# For golden tests: corda_add_golden_tests, and the matcher of corda/testing.hpp.
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SUGGESTS "corda, libgmock-dev")
set(CPACK_DEBIAN_DEVELOPMENT_DESCRIPTION "The C++ library, with one target, corda::corda, and one header, \
corda/corda.hpp: load or build a scene, simulate it, draw frames, write stills and video, and compare pictures.")

set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-corda)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS python3-matplotlib)  # plots, reports, figures of sweeps
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "${CORDA_PYTHON_DEPENDS}, python3-numpy, ${loaded}")
set(CPACK_DEBIAN_PYTHON_DESCRIPTION "The Python module corda: films as numpy arrays, as video files, and in notebooks; sweeps \
of a scene as labelled data sets.")
include(CPack)
