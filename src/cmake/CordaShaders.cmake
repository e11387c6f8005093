# corda_embed_shaders(<target> <files>): turns each shader file into a string constant of one generated source,
# corda::render::shaders::k<Name><Stage>, so that the program needs no other file at run time.
set(CORDA_EMBED_SCRIPT ${CMAKE_CURRENT_LIST_DIR}/embed_shaders.cmake)

function(corda_embed_shaders target)
    set(output_dir ${PROJECT_BINARY_DIR}/generated/${target})
    set(output ${output_dir}/embedded_shaders.hpp)
    add_custom_command(OUTPUT ${output}
        COMMAND ${CMAKE_COMMAND} -DOUTPUT=${output} "-DSHADERS=${ARGN}" -P ${CORDA_EMBED_SCRIPT}
        DEPENDS ${ARGN} ${CORDA_EMBED_SCRIPT} VERBATIM)
    target_sources(${target} PRIVATE ${output})
    target_include_directories(${target} PRIVATE ${output_dir})
endfunction()
